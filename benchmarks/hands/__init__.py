"""Gyros calibrated by hand: a simulated hand, the bound, and a recording beside its publication."""
