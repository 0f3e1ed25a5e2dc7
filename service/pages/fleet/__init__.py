"""The fleet page, its list and its reports."""
