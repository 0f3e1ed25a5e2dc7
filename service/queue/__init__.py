"""Background work that waits: one table, claimed by one process at a time."""
