"""Pages of several subjects: fleet, unit, session, type, stand, and help; each a frozen context and a template."""
