"""What is printed at once: the certificates of several sessions as one document."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from service.admission import PersonOf
from service.api.certificates import BYTES, PDF
from service.api.exports import as_file
from service.api.schemas.fields import Name, Text
from service.api.schemas.problem import errors
from service.dependencies import DeskOf, Now
from service.records.paper import NOT_STATED
from service.reports.together import hand_out_together

MOST = 25
"""Certificates of one document: each takes about a fifth of a second, most of it to draw its charts a first time."""

router = APIRouter(prefix="/certificates", tags=["handing on"])


@router.get("", responses={200: {"content": {PDF: BYTES}}, **errors(422, 507)}, response_class=Response)
def print_certificates(
    desk: DeskOf,
    now: Now,
    person: PersonOf,
    session: Annotated[list[Name], Query(min_length=1, max_length=MOST, description="Ids of sessions.")],
    *,
    by: Annotated[Text, Query(description="Who issues them; kept with their numbers.")] = "",
) -> Response:
    """Certificates to print, one after the other in one PDF.

    Each is issued as if it was asked for by itself. Electronic seals stay with the files of single certificates. If
    one session has none, the answer names it and there is no document.
    """
    paper = hand_out_together(desk, session, now, who=person.signs(by.strip()) or NOT_STATED)
    return as_file(paper.content, PDF, f"{paper.name}.pdf")
