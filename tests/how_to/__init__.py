"""The how-to pages of the documentation, followed step by step on a copy of the source."""
