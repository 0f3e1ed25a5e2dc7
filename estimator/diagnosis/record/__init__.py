"""Record errors and clipped channels: recognised by the nominal axes and the history, and corrected first."""
