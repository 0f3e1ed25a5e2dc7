"""What the service depends on, and under which licence."""
