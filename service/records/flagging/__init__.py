"""What raises flags and settles them, one reason a file."""
