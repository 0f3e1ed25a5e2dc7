"""Work beside the requests that waits: one table, claimed by one process at a time."""
