"""The page of a table of one's own layout."""
