"""What the simulation gets wrong on real recordings: a page and pictures a recording, made by one command."""
