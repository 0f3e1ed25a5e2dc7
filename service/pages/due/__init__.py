"""The due list: what must be calibrated when, by month, and where it is."""
