"""The demonstration fleet: simulated units that say so, uploaded the way a user uploads."""
