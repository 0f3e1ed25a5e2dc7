"""A fleet of any size in PostgreSQL, and what its pages cost."""
