"""Pages: contexts made of records, and what they say."""
