"""The page of a plan."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated
from urllib.parse import urlencode

import numpy as np
from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from estimator.message import joined, say
from estimator.planning import JudgedParameter, Plan, proposed_orientations, rank_of_orientations
from estimator.planning.expected import head_kind
from estimator.results import PARAMETERS
from estimator.session import ACCELEROMETER
from service.diagnosis.words.diagnosis import BlindCauses, SeenCause
from service.kit.measures import MEASURES, heading, number
from service.people.dependencies import StorageOf
from service.planning.charts import plan_charts
from service.planning.question import NOISE, VARIATION, PlanQuestion
from service.planning.rules import plan, plannable_types
from service.planning.words import (
    UNSEEN,
    VERDICTS,
    blind,
    duration,
    headline,
    seen,
    sigma_in_words,
    tolerance_in_words,
    unobserved,
)
from service.sessions.charts import ChartSet
from service.sessions.words.conditions import Condition
from service.web.render import render

CONDITIONS = {
    "enough": Condition("pass", "Enough", "circle", VERDICTS["enough"]),
    "usable": Condition("conditional-pass", "Usable", "triangle", VERDICTS["usable"]),
    "undecidable": Condition("undecidable", "Undecidable", "cross", VERDICTS["undecidable"]),
}
REACHED = Condition("pass", "Reached", "circle", "Every tolerance is reached.")
MISSED = Condition("undecidable", "Not reached", "cross", "Some tolerance is not reached.")
OPEN = Condition("none", "Not judged", "circle", "No tolerance was given.")


@dataclass(frozen=True)
class NumberField:
    """A number field of the form."""

    name: str
    label: str
    value: str
    hint: str
    step: str = "any"


@dataclass(frozen=True)
class ExpectedCell:
    """Expectation for one parameter of one sensor."""

    heading: str
    value: str
    tolerance: str
    condition: Condition | None


@dataclass(frozen=True)
class Row:
    """One sensor, or several with the same expectations."""

    name: str
    cells: tuple[ExpectedCell, ...]


@dataclass(frozen=True)
class PlanFact:
    """A fact of the plan in words."""

    name: str
    words: str


@dataclass(frozen=True)
class PlanPage:
    """Contents of the page of a plan."""

    question: PlanQuestion
    types: tuple[tuple[str, str], ...]
    """Stored unit types to choose from."""
    query: str
    """The question as the query of an address."""
    block: tuple[NumberField, ...]
    session: tuple[NumberField, ...]
    tolerances: tuple[NumberField, ...]
    condition: Condition
    headline: str
    facts: tuple[PlanFact, ...]
    rows: tuple[Row, ...]
    charts: tuple[ChartSet, ...]
    over_positions: tuple[tuple[str, ...], ...]
    over_elevation: tuple[tuple[str, ...], ...]
    detected: tuple[SeenCause, ...]
    unseen: tuple[BlindCauses, ...]
    optimal: tuple[PlanFact, ...]
    orientations: tuple[tuple[str, ...], ...]
    """Directions of up that identify everything without a stand; none for gyros."""
    headings: tuple[str, ...]


def plan_page(question: PlanQuestion, plan: Plan, types: Sequence[str] = ()) -> PlanPage:
    """The page of a planned session."""
    kind = head_kind(plan.schedule)
    return PlanPage(
        question=question,
        query=urlencode(question.model_dump(exclude_none=True)),
        types=(("", "a cone, as below"), *((name, name) for name in types)),
        block=_block(question),
        session=_session(question),
        tolerances=_tolerances(question),
        condition=OPEN if plan.reached is None else REACHED if plan.reached else MISSED,
        headline=headline(plan),
        facts=_facts(question, plan),
        rows=_rows(plan),
        charts=plan_charts(plan, kind),
        over_positions=_sweep(plan, kind, "over_positions"),
        over_elevation=_sweep(plan, kind, "over_elevation"),
        detected=seen(plan),
        unseen=_unseen(plan),
        optimal=_optimal(plan),
        orientations=_orientations(plan),
        headings=tuple(
            say("{name}, {label}", name=heading(name), label=MEASURES[kind, name].label) for name in PARAMETERS
        ),
    )


def _field(question: PlanQuestion, name: str, label: str, hint: str = "") -> NumberField:
    value = getattr(question, name)
    return NumberField(name, label, "" if value is None else f"{value:g}", hint)


def _block(q: PlanQuestion) -> tuple[NumberField, ...]:
    zero = MEASURES[q.kind, "bias"].label
    return (
        _field(q, "sensors", "Sensors on the cone"),
        _field(q, "noise", say("Noise of a reading, 1σ, {zero}", zero=zero), f"{NOISE[q.kind]:g}"),
        _field(q, "variation", say("Variation of the bias, 1σ, {zero}", zero=zero), f"{VARIATION[q.kind]:g}"),
    )


def _session(q: PlanQuestion) -> tuple[NumberField, ...]:
    return (
        _field(q, "elevation", "Elevation of the head, °", "proposed"),
        _field(q, "positions", "Positions a run", "proposed"),
        _field(q, "minutes", "Minutes a position"),
        _field(q, "latitude", "Latitude, °"),
        _field(q, "theta", "Levelling, 1σ, arcsec"),
        _field(q, "alpha_error", "Elevation, 1σ, arcsec"),
        _field(q, "beta_error", say("Turn β, 1σ, arcsec")),
    )


def _tolerances(q: PlanQuestion) -> tuple[NumberField, ...]:
    return tuple(
        _field(q, name, say("{name}, {label}", name=heading(name), label=MEASURES[q.kind, name].label), "not judged")
        for name in PARAMETERS
    )


def _facts(question: PlanQuestion, plan: Plan) -> tuple[PlanFact, ...]:
    ours, formula = (number(float(np.degrees(a)), 1) for a in (plan.elevation, plan.formula_elevation))
    return (
        PlanFact(
            "Elevation of the head",
            f"{ours}°" if question.elevation is not None else say("{angle}°, proposed", angle=ours),
        ),
        PlanFact("By the formula for the stand alone", f"{formula}°"),
        PlanFact(
            "Positions a run",
            (
                say("{positions}", positions=plan.positions)
                if question.positions is not None
                else say("{positions}, proposed", positions=plan.positions)
            ),
        ),
        PlanFact("Time", duration(plan.seconds)),
        PlanFact("Conditioning ρ", number(plan.conditioning, 1)),
        PlanFact("Equal steps against the best", f"{number(100 * plan.optimal.efficiency, 1)} %"),
    )


def _rows(plan: Plan) -> tuple[Row, ...]:
    """Sensors with equal cells share a row."""
    size, sensors_by_cells = len(PARAMETERS), dict[tuple[ExpectedCell, ...], list[str]]()
    for i in range(0, len(plan.judged), size):
        cells = tuple(_cell(parameter, plan.request.coverage) for parameter in plan.judged[i : i + size])
        sensors_by_cells.setdefault(cells, []).append(plan.judged[i].sensor)
    return tuple(Row(joined(", ", names), cells) for cells, names in sensors_by_cells.items())


def _cell(judged: JudgedParameter, coverage: float) -> ExpectedCell:
    return ExpectedCell(
        heading(judged.parameter),
        sigma_in_words(judged, coverage),
        tolerance_in_words(judged),
        CONDITIONS.get(judged.verdict),
    )


def _sweep(plan: Plan, kind: str, name: str) -> tuple[tuple[str, ...], ...]:
    """The numbers of a chart: abscissa, U of every parameter, ρ."""
    sweep = getattr(plan, name)
    abscissa = sweep.at if name == "over_positions" else np.degrees(sweep.at)
    factors = np.array([MEASURES[kind, p].factor for p in PARAMETERS]) * plan.request.coverage
    return tuple(
        (number(float(x)), *(number(float(f"{u:.3g}")) for u in row), number(float(rho), 1))
        for x, row, rho in zip(abscissa, sweep.total * factors, sweep.conditioning, strict=True)
    )


def _unseen(plan: Plan) -> tuple[BlindCauses, ...]:
    """Causes that are not seen, after parameters that are not observed."""
    missing = unobserved(plan)
    return (*([BlindCauses(missing, UNSEEN)] if missing else []), *blind(plan))


def _optimal(plan: Plan) -> tuple[PlanFact, ...]:
    best = plan.optimal
    degrees = np.round(np.degrees(best.beta)).astype(int)
    return tuple(
        PlanFact(name, joined(", ", (f"{d}°" for d in degrees[best.flipped == flipped])))
        for name, flipped in (("direct", False), ("flipped", True))
        if (best.flipped == flipped).any()
    )


def _orientations(plan: Plan) -> tuple[tuple[str, ...], ...]:
    sensors = plan.schedule.sensors
    if sum(s.kind == ACCELEROMETER for s in sensors) < 3:
        return ()
    proposed = rank_of_orientations(sensors, proposed_orientations(sensors)).directions
    return tuple(tuple(number(float(x), 2) for x in direction) for direction in proposed)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/plan")
def show_plan(request: Request, question: Annotated[PlanQuestion, Query()], storage: StorageOf) -> HTMLResponse:
    """Shows the uncertainties to be expected of a session before it is measured."""
    completed_question, result = plan(storage, question)
    return render(request, "plan.html", plan_page(completed_question, result, plannable_types(storage)))
