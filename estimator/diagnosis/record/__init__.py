"""Record errors and clipped channels: told against the nominal axes and the history, and put right first."""
