"""What the service does, one step a file; each reads as the list of its steps."""
