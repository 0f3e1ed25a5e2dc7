"""The pages of uploads: what came in, and what became of each file."""

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from service.measures import size_in_words
from service.pages.jobs import JobLine, job_line
from service.pages.list_view import Asked, address_of
from service.records.arrival import Arrival, ArrivalQuery, Refusal, refusal_number
from service.records.job import Job
from service.words.conditions import Condition, condition_of, said_with

PAGE_SIZE = 50
"""Uploads on a page: two screens."""
REFUSED = "refused"
PATH = "/uploads"


class ArrivalsAsked(BaseModel):
    """An address as it came."""

    q: Asked = ""
    only: Asked = ""
    after: Asked = ""
    """Identifier of a session, or number of a refusal after ``r``."""


@dataclass(frozen=True)
class ArrivalRow:
    """One upload."""

    arrival: Arrival
    filename: str
    size: str
    condition: Condition | None
    """Of the session; None of a refused file."""
    said: str
    """What became of it."""


@dataclass(frozen=True)
class ArrivalsPage:
    """Everything the list of uploads shows."""

    text: str
    refused: bool
    rows: tuple[ArrivalRow, ...]
    later: str
    """Address of the next page; empty where this is the last."""
    narrows: bool
    jobs: tuple[JobLine, ...]
    """Large files that are still being read."""


@dataclass(frozen=True)
class RefusalPage:
    """Everything the page of a refused upload shows."""

    refusal: Refusal
    size: str


def arrivals_query(asked: ArrivalsAsked) -> ArrivalQuery:
    """What the store is asked: one upload more than fit on the page."""
    refusal = refusal_number(asked.after)
    return ArrivalQuery(
        text=asked.q.strip() or None,
        refused=asked.only == REFUSED,
        after_session=asked.after or None if refusal is None else None,
        after_refusal=refusal,
        limit=PAGE_SIZE + 1,
    )


def arrivals_page(found: Sequence[Arrival], asked: ArrivalsAsked, jobs: Sequence[Job] = ()) -> ArrivalsPage:
    """One page of uploads."""
    shown, text, only = found[:PAGE_SIZE], asked.q.strip(), REFUSED if asked.only == REFUSED else ""
    after = {"q": text, "only": only, "after": shown[-1].name} if len(found) > PAGE_SIZE else {}
    return ArrivalsPage(
        text=text,
        refused=bool(only),
        rows=tuple(map(_row, shown)),
        later=address_of(PATH, after) if after else "",
        narrows=bool(text or only or asked.after),
        jobs=tuple(map(job_line, jobs)),
    )


def refusal_page(refusal: Refusal) -> RefusalPage:
    """The page of one refused upload."""
    return RefusalPage(refusal, size_in_words(refusal.size))


def _row(arrival: Arrival) -> ArrivalRow:
    session, refusal = arrival.session, arrival.refusal
    if refusal is not None:
        count = len(refusal.problems)
        said = f"{count} problem{'' if count == 1 else 's'}: nothing was stored"
        return ArrivalRow(arrival, refusal.filename, size_in_words(refusal.size), None, said)
    assert session is not None, "an arrival is one of the two"
    condition = said_with(condition_of(session.verdict, is_reference=session.is_reference), session.reservations)
    return ArrivalRow(arrival, session.filename, size_in_words(session.size), condition, session.reason)
