"""A session against its unit: plausible, of this unit, within tolerance, with which reservations."""
