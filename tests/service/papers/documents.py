"""Text of a PDF, page by page."""

import io

from pypdf import PdfReader


def pages_of(content: bytes) -> list[str]:
    """The text of every page, white space as single spaces."""
    return [" ".join(page.extract_text().split()) for page in PdfReader(io.BytesIO(content)).pages]


def text_of(content: bytes) -> str:
    """The text of the whole document."""
    return " ".join(pages_of(content))
