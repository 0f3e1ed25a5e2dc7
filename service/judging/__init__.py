"""A session against its unit's reference: tolerances, decisions, forecasts. Nothing here writes."""
