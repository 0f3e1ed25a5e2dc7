"""When a unit must come back and why: drift, forecast, risk."""
