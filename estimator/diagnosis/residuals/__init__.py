"""What the baseline leaves of a session: whitened and projected residuals, moves between sessions, gauge freedom."""
