"""Residuals of the baseline: whitened and projected; changes between sessions; gauge freedom."""
