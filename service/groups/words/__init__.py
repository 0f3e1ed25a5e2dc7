"""Sentences on groups."""
