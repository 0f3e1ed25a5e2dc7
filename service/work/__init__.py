"""Background work: diagnoses, messages to other programs, due dates and stands."""
