"""Units by serial number: what was done to them, remarks and files, the states of their records."""
