"""Studies whose generators share nothing with what they judge."""
