"""Kills the service, and the database, again and again while clients upload, and looks for what was lost."""
