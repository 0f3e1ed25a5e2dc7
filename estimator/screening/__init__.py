"""Raw files, before they are averaged: what is no reading is corrected or left out by name, or the file refused."""

from estimator.session import ScreenFinding

Screening = tuple[ScreenFinding, ...]
"""Everything that was found in one file."""

__all__ = ["ScreenFinding", "Screening"]
