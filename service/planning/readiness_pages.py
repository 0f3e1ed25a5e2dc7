"""The pages before and during a measurement: ready or not, and the missing positions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, TypeVar

from fastapi import APIRouter, Depends, Request
from fastapi.responses import HTMLResponse
from pydantic import BaseModel, BeforeValidator, Field, ValidationError

from estimator.errors import Problem
from estimator.message import joined, say
from estimator.planning import ExpectedSigma, Missing
from estimator.readiness import DriftOutlook, Readiness, ReadinessState
from estimator.results import PARAMETERS
from service.errors import RefusedError
from service.kit.measures import COVERAGE, MEASURES, THIN, heading, number
from service.people.dependencies import StorageOf
from service.planning.charts import readiness_charts
from service.planning.pattern import type_names
from service.planning.question import ReadyQuestion, blank
from service.planning.rules import Asked, missing_of, readiness_of
from service.planning.words import amount, clock, minutes, missing_in_words, readiness_headline, reasons
from service.sessions.charts import ChartSet
from service.sessions.sent import SentFile
from service.sessions.words.conditions import Condition
from service.uploads.received import ArrivingOf, LandedFile
from service.web.dependencies import Reading
from service.web.faults import fault_in_words
from service.web.render import render

READY = Condition("pass", "Ready", "circle", "The measurement may begin.")
WAIT = Condition("conditional-pass", "Not yet", "triangle-up", "Wait, or record for longer.")
NOT_STILL = Condition("fail", "Not still", "square", "It moves or vibrates.")
NOTHING = Condition("none", "No usable data", "stroke", "The record contains no information.")
CONDITIONS = {
    ReadinessState.READY: READY,
    ReadinessState.NOT_STILL: NOT_STILL,
    ReadinessState.NOT_WARM: WAIT,
    ReadinessState.TOO_EARLY: WAIT,
    ReadinessState.CANNOT_TELL: NOTHING,
}
UNSEEN = "not observed"
MOST_ROWS = 20
"""Most rows in the table of changes: every fifth mean is enough for reading."""


@dataclass(frozen=True)
class Drift:
    """Expected drift of one sensor or of the thermometer."""

    name: str
    expected: str
    bound: str
    allowed: str
    share: str
    """Shares of the tolerances of bias and scale factor."""


@dataclass(frozen=True)
class ReadyPage:
    """Everything the page of readiness shows; before a file was sent only its form."""

    asked: ReadyQuestion
    types: tuple[tuple[str, str], ...]
    unit: str = ""
    condition: Condition | None = None
    headline: str = ""
    reasons: tuple[str, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    drifts: tuple[Drift, ...] = ()
    charts: ChartSet | None = None
    names: tuple[str, ...] = ()
    changes: tuple[tuple[str, ...], ...] = ()
    """The chart as a table: minutes, then every sensor."""


def ready_form(asked: ReadyQuestion, types: Sequence[str]) -> ReadyPage:
    """The page before a file was sent."""
    return ReadyPage(asked, (("", "that of the file's unit"), *((name, name) for name in types)))


def ready_page(asked: ReadyQuestion, types: Sequence[str], answer: Asked) -> ReadyPage:
    """The page with the answer."""
    found = answer.found
    kinds = {**dict.fromkeys(found.names, answer.kind), **{outlook.name: outlook.kind for outlook in found.outlooks}}
    judged = found.outlooks if found.temperature is None else (*found.outlooks, found.temperature)
    return ReadyPage(
        asked,
        ready_form(asked, types).types,
        found.unit,
        CONDITIONS[found.state],
        readiness_headline(found),
        reasons(found, answer.kind),
        _facts(answer),
        tuple(map(_drift, judged)),
        readiness_charts(found, kinds),
        found.names,
        _changes(found, kinds),
    )


def _facts(answer: Asked) -> tuple[tuple[str, str], ...]:
    found = answer.found
    facts = [
        ("Recorded", clock(found.recorded)),
        ("Judged from", clock(found.judged_from)),
        (
            "Programme",
            (
                say("{duration} min, as is usual", duration=minutes(found.duration))
                if answer.is_usual
                else say("{duration} min", duration=minutes(found.duration))
            ),
        ),
        ("Tolerances of", answer.unit_type or "no unit type: the usual ones"),
    ]
    if found.warmed is not None:
        facts.append(("Thermometer", say("{warmed} K since then", warmed=number(found.warmed, 2))))
    return tuple(facts)


def _drift(drift: DriftOutlook) -> Drift:
    shares = [
        say("{share} % of the {kind}", share=number(100 * share, 0), kind=word)
        for share, word in ((drift.bias_share, "bias"), (drift.scale_share, "scale factor"))
        if share is not None
    ]
    expected, bound, allowed = (amount(drift.kind, value) for value in (drift.expected, drift.bound, drift.allowed))
    return Drift(drift.name, expected, bound, allowed, joined(", ", shares))


def _changes(found: Readiness, kinds: dict[str, str]) -> tuple[tuple[str, ...], ...]:
    step = max(1, -(-len(found.time) // MOST_ROWS))
    return tuple(
        (clock(at), *(amount(kinds[name], value) for name, value in zip(found.names, row, strict=True)))
        for at, row in zip(found.time[::step], found.change[::step].tolist(), strict=True)
    )


@dataclass(frozen=True)
class MissingPage:
    """Contents of the page of missing positions; before a file was sent only its form."""

    positions: int | None
    runs: str
    condition: Condition | None = None
    headline: str = ""
    lines: tuple[str, ...] = ()
    headings: tuple[str, ...] = ()
    rows: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = ()
    """Sensor; of every parameter U so far and when complete."""


def missing_page(positions: int | None, runs: str, found: Missing | None = None) -> MissingPage:
    """The page, with the answer where a file was sent."""
    if found is None:
        return MissingPage(positions, runs)
    first, *lines = missing_in_words(found)
    condition = READY if found.is_complete else WAIT
    named = Condition(condition.key, "Complete" if found.is_complete else "Incomplete", "circle", first)
    headings = tuple(map(heading, PARAMETERS)) if found.expected else ()
    return MissingPage(positions, runs, named, first, tuple(lines), headings, _known(found.expected))


def _known(expected: tuple[ExpectedSigma, ...]) -> tuple[tuple[str, tuple[tuple[str, str], ...]], ...]:
    size = len(PARAMETERS)
    return tuple(
        (expected[i].sensor, tuple((_spread(e, e.so_far), _spread(e, e.complete)) for e in expected[i : i + size]))
        for i in range(0, len(expected), size)
    )


def _spread(estimate: ExpectedSigma, sigma: float | None) -> str:
    """``±2.1 µg``: the expanded uncertainty."""
    if sigma is None:
        return UNSEEN
    measure = MEASURES[estimate.kind, estimate.parameter]
    return f"±{number(float(f'{COVERAGE * sigma * measure.factor:.2g}'))}{THIN}" + measure.label


T = TypeVar("T", bound=BaseModel)

NO_FILE = "The file is missing from the form: choose it again."

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


class Programme(BaseModel):
    """Fields of the form for missing positions."""

    positions: Annotated[Annotated[int, Field(ge=2, le=360)] | None, BeforeValidator(blank)] = None
    runs: Annotated[str, Field(pattern="^(both|direct)$")] = "both"


@dataclass(frozen=True)
class Brought:
    """A file, and the fields beside it."""

    file: SentFile
    fields: dict[str, str]


async def _brought(arriving: ArrivingOf) -> Brought:
    form = await arriving.form(most_files=1)
    file = form.get("file")
    if not isinstance(file, LandedFile) or not file.filename:
        raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
    fields = {name: value for name, value in form.items() if isinstance(value, str)}
    return Brought(SentFile(file.filename, await file.content()), fields)


BroughtOf = Annotated[Brought, Depends(_brought)]
"""File and fields that the form sent."""


@router.get("/ready")
def show_ready_form(request: Request, store: Reading) -> HTMLResponse:
    """The form."""
    return render(request, "ready.html", ready_form(ReadyQuestion.model_validate({}), type_names(store)))


@router.post("/ready")
def show_ready(request: Request, brought: BroughtOf, storage: StorageOf) -> HTMLResponse:
    """Ready, wait, or not still."""
    asked = _read(ReadyQuestion, brought)
    answer = readiness_of(storage, brought.file, asked)
    with storage.database.reading() as store:
        types = type_names(store)
    return render(request, "ready.html", ready_page(asked, types, answer))


@router.get("/missing")
def show_missing_form(request: Request) -> HTMLResponse:
    """The form."""
    return render(request, "missing.html", missing_page(None, "both"))


@router.post("/missing")
def show_missing(request: Request, brought: BroughtOf) -> HTMLResponse:
    """Shows the positions still to be measured and the uncertainties so far."""
    asked = _read(Programme, brought)
    found = missing_of(brought.file, asked.positions, both_runs=asked.runs == "both")
    return render(request, "missing.html", missing_page(asked.positions, asked.runs, found))


def _read(kind: type[T], brought: Brought) -> T:
    try:
        return kind.model_validate({name: value.strip() for name, value in brought.fields.items()})
    except ValidationError as fault:
        problems = tuple(Problem(".".join(map(str, error["loc"])), fault_in_words(error)) for error in fault.errors())
        raise RefusedError("The form cannot be used.", problems) from fault
