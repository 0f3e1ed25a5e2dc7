"""Stored sessions: calibrations, decisions, histories, noise at rest."""
