"""What only the papers need: printed formulas, and the published search by triples and coordinate descent."""
