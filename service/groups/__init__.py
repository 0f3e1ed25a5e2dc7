"""Joint diagnosis of the sessions of a unit, a unit type or a stand."""
