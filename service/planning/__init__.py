"""Planning of sessions and readiness of units, before a measurement."""
