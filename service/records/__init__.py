"""Changes of records, and everything derived from records made again."""
