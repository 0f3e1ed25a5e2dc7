"""Whether forecasts, which take errors for normal, keep their word where errors have tails."""
