"""Sentences on sessions."""
