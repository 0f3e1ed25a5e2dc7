"""What becomes of records, and everything that is derived of them again."""
