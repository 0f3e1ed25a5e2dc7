"""What is kept of work beside the requests where nothing else is known of its failure."""

AT_FAULT = "the program failed at it: see the log"
"""In place of Python's words."""


def too_long(seconds: float) -> str:
    """Of what was ended because it was not done in time."""
    return f"it was not done within {seconds:g} s, the longest that it may take"
