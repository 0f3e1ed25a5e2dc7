"""The page of a table of custom layout."""
