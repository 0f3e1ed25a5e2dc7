"""An open benchmark: blind sessions, sealed truths, and marks for whoever answers."""
