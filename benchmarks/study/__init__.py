"""Studies of how well the diagnosis finds hidden effects: thousands of sessions, one page of figures."""
