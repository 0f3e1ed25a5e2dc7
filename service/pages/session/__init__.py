"""The page of a session, the list of sessions, and two beside each other."""
