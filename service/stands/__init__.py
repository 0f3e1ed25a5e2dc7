"""Stands: their health, as the units measured on them show it, and their certificates."""
