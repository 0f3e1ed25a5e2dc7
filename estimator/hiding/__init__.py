"""A cause of the catalogue hidden in a session whose truth is known, for the diagnosis to find."""

from estimator.hiding.hidden import Hidden, TooWeakError, UnhideableError
from estimator.hiding.hide import hide, hide_any, with_input

__all__ = ["Hidden", "TooWeakError", "UnhideableError", "hide", "hide_any", "with_input"]
