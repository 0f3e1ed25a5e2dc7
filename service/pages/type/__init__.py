"""The pages of unit types."""
