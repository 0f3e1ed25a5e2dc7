"""Units by serial number: services, notes, attachments, and the states of their records."""
