"""How histories become forecasts, and units stand out of their type."""
