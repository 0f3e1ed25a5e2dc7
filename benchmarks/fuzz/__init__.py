"""Readers given damaged files, guided by the code that they reach."""
