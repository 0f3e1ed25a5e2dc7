"""The findings for people: rivals, sensor or stand, limits, next measurement, extended model, gain."""
