"""Work beside the requests: diagnoses, messages to other programs, due dates and stands."""
