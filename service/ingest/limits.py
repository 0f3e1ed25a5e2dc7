"""What an upload may hold, so that a small file cannot become a big one in memory."""

from estimator.errors import FormatError, Problem

MOST_CELLS = 30_000_000
"""Rows × columns of a table; 240 MB as numbers."""
MOST_TEXT = 256 * 1024 * 1024
"""Bytes of text, unpacked."""


def refusal(filename: str, message: str, field: str = "file") -> FormatError:
    """The error for a file that cannot be read at all."""
    return FormatError([Problem(field, message)], filename)


def check_cells(filename: str, rows: int, columns: int) -> None:
    """Raises when a table of this size is beyond the limit."""
    if rows * columns > MOST_CELLS:
        raise refusal(
            filename,
            f"has {rows} rows × {columns} columns; at most {MOST_CELLS} cells can be read, so average or split it",
            "table",
        )
