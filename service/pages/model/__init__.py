"""The page of an accepted cause."""
