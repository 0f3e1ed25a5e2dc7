"""What a group shows, as a section of the pages of its unit, type or stand."""
