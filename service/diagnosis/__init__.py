"""Diagnosis of a session: causes of the differences between its readings and the simulation."""
