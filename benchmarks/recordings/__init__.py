"""Real recordings: our calibration beside the published one. `python -m benchmarks.recordings` prints the tables."""
