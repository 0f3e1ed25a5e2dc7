"""Kinds of unit: their nominal model and their tolerances, revision by revision."""
