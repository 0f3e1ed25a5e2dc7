"""Sentences on diagnoses."""
