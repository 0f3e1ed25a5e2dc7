"""The pages of stands."""
