"""The report of the whole fleet: on paper, as a workbook, as a file."""
