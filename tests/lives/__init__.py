"""Whole lives of units."""
