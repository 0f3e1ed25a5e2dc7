"""Sentences on outlooks."""
