"""The pages of unit types."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Depends, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.message import joined, say
from estimator.session import ACCELEROMETER, GYROSCOPE
from estimator.wording import counted
from service.flags.pages import FlagCard, flag_cards
from service.flags.records import Flag
from service.flags.store import FlagQuery, Flags
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.fleet.uses_store import Uses
from service.groups.records import Level
from service.groups.sections import GroupSection, group_section
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.kit.measures import deviation_measure, heading, in_measure, limit, number, scale_measure
from service.models.records import ModelRevision, Scope
from service.models.rules import in_force
from service.models.sections import AcceptedCause, accepted_causes
from service.models.store import Models
from service.pages.fleet.pages import FleetRow, UseCount, fleet_row, use_counts
from service.pages.fleet.view import FleetView
from service.pages.type.laws import laws_in_words, put_in_force
from service.pages.type.proposal import proposed as proposed_by_sessions
from service.pages.type.tolerances import (
    STORED,
    ToleranceField,
    days,
    preview_page,
    preview_tolerances,
    set_tolerances,
    share,
    tolerance_fields,
    wanted,
)
from service.people.dependencies import SEE_OTHER, By, Key, StorageOf, Why
from service.sessions.records import PARAMETERS
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.records import ToleranceRevision, UnitType, WantedTolerances
from service.types.rules import tolerances_of
from service.types.store import UnitTypes
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.render import render

MOST_TYPES = 500
"""Most types in the list: no maker has more kinds of unit."""
MOST = 25
"""Units that the page of one type lists: a screen; the fleet's page has all."""


@dataclass(frozen=True)
class TypeLine:
    """One type in the list."""

    unit_type: UnitType
    units: int
    uses: Mapping[Use, int]
    """Number of its units with each answer."""


@dataclass(frozen=True)
class TypeReport:
    """One type; one unit more than are listed says that there are others."""

    line: TypeLine
    kinds: Mapping[str, str]
    """Kinds of its sensors, where a session stated them."""
    revisions: tuple[ToleranceRevision, ...]
    """Revisions of its tolerances, oldest first."""
    setters: Mapping[datetime, str]
    """Persons who set the tolerances, by time; the first ones have none."""
    flags: tuple[Flag, ...]
    """Open flags on joint findings of its sessions."""
    units: tuple[UnitSummary, ...]
    """Units, worst first."""
    uses: Mapping[str, Usable]
    models: tuple[ModelRevision, ...]
    """Causes that engineers accepted into its model, and that hold."""


def every_type(store: Store, now: datetime) -> tuple[TypeLine, ...]:
    """All types, by name."""
    units, uses = UnitTypes(store).uses(), Uses(store).by_type_at(now)
    known = UnitTypes(store).page(0, MOST_TYPES)
    return tuple(TypeLine(one, units[one.name].units, uses.get(one.name, {})) for one in known)


def type_report(store: Store, name: str, now: datetime) -> TypeReport:
    """One type; NotFoundError where there is none of that name."""
    unit_type = UnitTypes(store).get(name)
    revisions, units = UnitTypes(store).revisions(name), Fleet(store).units(FleetQuery(unit_type=name, limit=MOST + 1))
    return TypeReport(
        line=TypeLine(unit_type, UnitTypes(store).uses(name)[name].units, Uses(store).by_type_at(now).get(name, {})),
        kinds=UnitTypes(store).kinds(name),
        revisions=revisions,
        setters=Audit(store).who_did("tolerances", name, [revision.since for revision in revisions]),
        flags=Flags(store).page(FlagQuery(unresolved=True, unit_type=name)),
        units=units,
        uses=usable_of(store, units, now),
        models=in_force(Models(store).of_subject(Scope.UNIT_TYPE, name)),
    )


DEFAULTS = "the service itself, with the first session of the type"
"""Words in place of a person, for the first tolerances of a type."""
NOT_JUDGED = "not judged"
KINDS = {ACCELEROMETER: "accelerometer", GYROSCOPE: "gyro"}
"""Usual names of the kinds of sensor."""


@dataclass(frozen=True)
class TypeRow:
    """One type in the list."""

    name: str
    block: str
    units: int
    counts: tuple[UseCount, ...]
    """Counts by permitted use, worst first, none without a unit."""
    tolerances: tuple[str, ...]


@dataclass(frozen=True)
class TypesPage:
    """Everything the list of types shows."""

    rows: tuple[TypeRow, ...]


@dataclass(frozen=True)
class SensorModel:
    """A sensor as its maker describes it."""

    name: str
    kind: str
    axis: str
    scale: str


@dataclass(frozen=True)
class RevisionRow:
    """One revision of the tolerances, by parameter and kind."""

    revision: int
    since: datetime
    who: str
    limits: tuple[tuple[str, str], ...]
    """Parameters with their limits."""
    laws: str
    """Number of units behind the temperature laws in force, in words."""


@dataclass(frozen=True)
class TypePage:
    """Everything the page of one type shows."""

    row: TypeRow
    interval: str
    revisions: tuple[RevisionRow, ...]
    """Revisions, newest first: the first one holds."""
    sensors: tuple[SensorModel, ...]
    units: tuple[FleetRow, ...]
    more: bool
    """Whether there are units that are not listed."""
    flags: tuple[FlagCard, ...]
    causes: tuple[AcceptedCause, ...]
    group: GroupSection | None
    fields: tuple[ToleranceField, ...]
    """Fields of the form that sets other tolerances."""
    days: str
    """The longest interval, in the form."""
    share: str
    """Share of the tolerance, %, from which on a change has a flag, in the form."""
    laws: tuple[str, ...]
    """Temperature laws in force, in words."""
    are_entered: bool
    """Whether somebody entered the tolerances."""
    is_proposed: bool
    """Whether the form holds what the calibrations so far achieve."""


def types_page(types: Sequence[TypeLine]) -> TypesPage:
    """The list of types."""
    return TypesPage(tuple(map(_row, types)))


def type_page(
    report: TypeReport, group: GroupSection | None = None, proposal: WantedTolerances | None = None
) -> TypePage:
    """The page of one type, with a ``proposal`` of tolerances in the form."""
    known = report.line.unit_type
    kinds = {name: report.kinds.get(name, known.block) for name in known.sensors}
    return TypePage(
        row=_row(report.line),
        interval=counted(round(known.maximum_interval_days), "day"),
        revisions=tuple(_revision(revision, known, report) for revision in reversed(report.revisions)),
        sensors=tuple(
            _sensor(name, kinds[name], axis, scale)
            for name, axis, scale in zip(known.sensors, known.nominal_axes, known.nominal_scales, strict=True)
        ),
        units=tuple(fleet_row(unit, report.uses[unit.serial]) for unit in report.units[:MOST]),
        more=len(report.units) > MOST,
        flags=flag_cards(report.flags),
        causes=accepted_causes(report.models),
        group=group,
        fields=tolerance_fields(
            known
            if proposal is None
            else replace(known, tolerances=proposal.tolerances, gyro_tolerances=proposal.gyro_tolerances)
        ),
        days=days(known),
        share=share(known),
        laws=laws_in_words(known),
        are_entered=known.are_entered,
        is_proposed=proposal is not None,
    )


def _row(line: TypeLine) -> TypeRow:
    known = line.unit_type
    counts = tuple(one for one in use_counts(line.uses, FleetView(type=known.name)) if one.count)
    named = [
        say("{quantity} {amount}", quantity=name, amount=text) for name, text in _limits(known) if text != NOT_JUDGED
    ]
    return TypeRow(known.name, _block(known), line.units, counts, tuple(named))


def _block(known: UnitType) -> str:
    """``6 accelerometers``."""
    count = len(known.sensors)
    if known.gyro_tolerances is not None:
        return say("{count} accelerometers and gyros", count=count)
    return counted(count, KINDS.get(known.block, known.block)) if known.block else "Not measured yet"


def _revision(limits: ToleranceRevision, known: UnitType, report: TypeReport) -> RevisionRow:
    who = report.setters.get(limits.since, DEFAULTS if limits.revision == 1 else "not recorded")
    held = replace(known, tolerances=limits.tolerances, gyro_tolerances=limits.gyro_tolerances)
    units = max((law.units for law in limits.temperature_laws), default=0)
    return RevisionRow(limits.revision, limits.since, who, _limits(held), counted(units, "unit") if units else "none")


def _limits(known: UnitType) -> tuple[tuple[str, str], ...]:
    allowed = tolerances_of(known)
    kinds = (known.block,) if known.gyro_tolerances is None else (ACCELEROMETER, GYROSCOPE)
    kind_words = {kind: f"{KINDS.get(kind, kind)}s" if len(kinds) > 1 else "" for kind in kinds}
    return tuple(
        (joined(", ", filter(None, (heading(name), kind_words[kind]))), _limit(kind, name, allowed.get((kind, name))))
        for kind in kinds
        for name in PARAMETERS
    )


def _limit(kind: str, parameter: str, tolerance: float | None) -> str:
    if tolerance is None:
        return NOT_JUDGED
    return limit(tolerance, deviation_measure(kind, parameter, tolerance), parameter == "axis")


def _sensor(name: str, kind: str, axis: tuple[float, float, float], scale: float) -> SensorModel:
    measure = scale_measure(kind)
    vector = ", ".join(number(x, 4) for x in axis)
    return SensorModel(
        name,
        KINDS.get(kind, kind),
        f"({vector})",
        say("{scale} {label}", scale=number(in_measure(scale, measure)), label=measure.label),
    )


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/unit-types")
def show_types(request: Request, store: Reading, now: Now) -> HTMLResponse:
    """Every unit type with its tolerances and what its units may be used for."""
    return render(request, "unit_types.html", types_page(every_type(store, now)))


async def _form(request: Request) -> dict[str, str]:
    """The numbers of the form, as they were written."""
    return {key: value for key, value in (await request.form()).items() if isinstance(value, str)}


@router.post("/unit-types/{name:path}/tolerances")
def set_limits(
    name: Key,
    by: By,
    why: Why,
    seen: Annotated[int, Form(ge=1, le=2_000_000_000)],
    form: Annotated[dict[str, str], Depends(_form)],
    *,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Other tolerances from the next session on, or of stored ones too; the interval and the share at once."""
    with storage.database.reading() as store:
        asked = wanted(UnitTypes(store).get(name), form)
    limits, watch = (asked.tolerances, asked.gyro_tolerances), asked.watch
    is_stored = STORED in form
    set_tolerances(storage, name, *limits, now, watch=watch, who=by, why=why, seen=seen, stored=is_stored)
    return RedirectResponse(f"/unit-types/{quote(name)}#tolerances", SEE_OTHER)


@router.post("/unit-types/{name:path}/laws")
def set_laws(
    name: Key, by: By, why: Why, wanted: Annotated[bool, Form()], *, storage: StorageOf, now: Now
) -> RedirectResponse:
    """The type's temperature laws from the next session on, learned from its sessions now, or none."""
    put_in_force(storage, name, now, who=by, why=why, wanted=wanted)
    return RedirectResponse(f"/unit-types/{quote(name)}#laws", SEE_OTHER)


@router.post("/unit-types/{name:path}/tolerances/preview")
def preview_limits(
    request: Request, name: Key, form: Annotated[dict[str, str], Depends(_form)], store: Reading, settings: SettingsOf
) -> HTMLResponse:
    """Shows the effect of other tolerances; nothing is stored."""
    known = UnitTypes(store).get(name)
    asked = wanted(known, form)
    found = preview_tolerances(
        store, name, WantedTolerances(asked.tolerances, asked.gyro_tolerances), settings.coverage_factor
    )
    return render(request, "tolerance_preview.html", preview_page(known, asked, form, found))


@router.get("/unit-types/{name:path}")
def show_type(request: Request, store: Reading, now: Now, name: Key, *, proposed: bool = False) -> HTMLResponse:
    """Shows one unit type: its tolerances and who set them, the nominal model, its units; with ``proposed`` tolerances
    in the form.
    """
    report, group = type_report(store, name, now), group_section(store, Level.TYPE, name)
    proposal = proposed_by_sessions(store, report.line.unit_type) if proposed else None
    return render(request, "unit_type.html", type_page(report, group, proposal))
