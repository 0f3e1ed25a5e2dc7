"""What changes the store, one verb a file; each reads as the list of its steps."""
