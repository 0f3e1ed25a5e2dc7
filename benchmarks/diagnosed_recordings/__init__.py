"""Diagnoses of real recordings: a page with pictures for each recording, made by one command."""
