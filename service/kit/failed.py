"""What is kept of work beside the requests where nothing else is known of its failure."""

from estimator.message import say

AT_FAULT = "the program failed at it: see the log"
"""In place of Python's words."""


def too_long(seconds: float) -> str:
    """Of what was ended because it was not done in time."""
    return say("it was not done within {seconds} s, the longest that it may take", seconds=f"{seconds:g}")
