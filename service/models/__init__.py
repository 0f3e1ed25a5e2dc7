"""The causes that engineers accepted, as numbered revisions of models."""
