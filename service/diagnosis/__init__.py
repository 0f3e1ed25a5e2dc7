"""What the simulation gets wrong about a session."""
