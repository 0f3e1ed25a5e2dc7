"""Plans: what a session would tell, and whether a unit is ready, before it is measured."""
