"""What is read and put together for showing."""
