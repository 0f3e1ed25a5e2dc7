"""What came in and what became of it: pages, and the same over HTTP."""
