"""Certificates of several sessions as one document to print: the pages of each, in the order asked for.

What binds an electronic seal to a file does not survive in another one, so what is put together has none.
"""

from collections.abc import Sequence
from datetime import datetime
from io import BytesIO

from pypdf import PdfReader, PdfWriter

from estimator.errors import Problem
from service.errors import ConflictError, NotFoundError, RefusedError
from service.papers.desk import Desk, HandedOut, certified, issued

NOT_ALL = "Not every one of these sessions has a certificate: leave out those named here. Nothing was issued."


def hand_out_together(desk: Desk, ids: Sequence[str], now: datetime, *, who: str) -> HandedOut:
    """The certificates that hold, each under its number, page after page.

    Raises
    ------
    RefusedError
        A session is not stored or does not count; every such one is named.
    """
    stated, problems = [], list[Problem]()
    for id in dict.fromkeys(ids):
        try:
            stated.append(certified(desk, id))
        except (ConflictError, NotFoundError) as error:
            problems.append(Problem(id, error.detail))
    if problems:
        raise RefusedError(NOT_ALL, tuple(problems))
    papers = [issued(desk, one, "pdf", now, who=who) for one in stated]
    if len(papers) == 1:
        return papers[0]
    return HandedOut(f"certificates-{now:%Y-%m-%d}", joined([paper.content for paper in papers]))


def joined(documents: Sequence[bytes]) -> bytes:
    """PDF documents as one, without what is filled in or signed in them."""
    writer = PdfWriter()
    for document in documents:
        for page in PdfReader(BytesIO(document)).pages:
            writer.add_page(page)
    writer.remove_annotations("/Widget")
    file = BytesIO()
    writer.write(file)
    return file.getvalue()
