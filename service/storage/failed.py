"""What is kept of work beside the requests where nothing else is known of its failure."""

AT_FAULT = "the program failed at it: see the log"
"""In place of Python's words."""
