"""Every sentence made from results: one fact is said in one way."""
