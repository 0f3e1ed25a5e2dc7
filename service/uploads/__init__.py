"""Bytes to verdict: uploads, large files, custom layouts, templates."""
