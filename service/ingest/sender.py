"""Who sends a file: an account, or an address where nobody signs in. No one of them takes every place for reading."""

from contextvars import ContextVar

SENDER: ContextVar[str] = ContextVar("sender", default="")
"""Of the request at hand; empty beside the requests, where files wait in a queue of their own."""
