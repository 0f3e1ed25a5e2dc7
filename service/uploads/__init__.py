"""Bytes to verdict: uploads, large files, own layouts, templates."""
