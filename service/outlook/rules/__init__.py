"""Rules for forecasts from histories, and for units that stand out of their type."""
