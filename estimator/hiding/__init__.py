"""A cause of the catalogue hidden in a session whose truth is known, for the diagnosis to find."""

from estimator.hiding.hidden import HiddenCause, TooWeakError, UnhideableError
from estimator.hiding.hide import hide, hide_any, with_input

__all__ = ["HiddenCause", "TooWeakError", "UnhideableError", "hide", "hide_any", "with_input"]
