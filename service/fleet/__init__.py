"""The fleet at a glance, and the one question whether a unit may be used."""
