"""Units: their condition, history and known breaks, and their permitted use."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response
from pydantic import TypeAdapter

from estimator.json_object import Json
from service.flags.api import FlagPage, WantedState, flag_page
from service.flags.store import FlagQuery
from service.fleet.records import FleetQuery, Order, UseAt
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.judging.records import Usable
from service.judging.usable_reading import usable_unit
from service.kit.answer import answer
from service.kit.libraries import pl
from service.languages.catalogue import said_in
from service.languages.language import asked
from service.outlook.reading import outlook_of
from service.outlook.records import OutlookAnswer, RiskPoint
from service.pages.unit.report import covered_now, unit_report
from service.pages.unit.schemas import (
    HistoryAsked,
    HistoryPage,
    NewLot,
    SaidUnit,
    UnitPage,
    UnitReportSchema,
    said_unit,
    units_in_use,
)
from service.papers.schemas import NewCustomer
from service.people.admission import PersonOf
from service.people.dependencies import CREW, StorageOf
from service.records.recalibrate import Recalibrated, recalibrate
from service.records.unit_changes import set_customer, set_lot
from service.sessions.history_store import History
from service.sessions.records import HistoryPoint
from service.units.records import Customer
from service.units.store import Units
from service.web.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.web.fields import Bound, Moment, Serial, Sought, WantedText, WantedVerdict, WindowOf
from service.web.files import BY_HEADER, TABLES, as_table, table_of, wanted_form
from service.web.problem_document import errors
from service.work.dependencies import ReaderOf, ReadingFleet

HISTORY_COLUMNS = {
    "session": str, "at": datetime, "sensor": str, "kind": str, "parameter": str,
    "value": float, "u": float, "lower": float, "upper": float,
    "reference": float, "deviation": float, "expanded": float, "tolerance": float,
    "verdict": str, "is_reference": bool,
    "axis_x": float, "axis_y": float, "axis_z": float, "revision": int,
    "at_ms": int, "unit": str,
}  # fmt: skip


NO_AXIS = (None, None, None)
"""Axis of a parameter that is a number."""


def history_table(serial: str, points: Sequence[HistoryPoint]) -> "pl.DataFrame":
    """One row a point of a unit's history; the axis as three columns."""
    return table_of([_point_row(serial, point) for point in points], HISTORY_COLUMNS)


def _point_row(serial: str, point: HistoryPoint) -> dict[str, Any]:
    axis = dict(zip(("axis_x", "axis_y", "axis_z"), point.axis or NO_AXIS, strict=True))
    return vars(point) | axis | {"at_ms": point.at_ms, "unit": serial}


router = APIRouter(prefix="/units", tags=["units"])
USE_FIRST = Order.USE


@router.get("", responses=errors(422))
def list_units(
    store: ReadingFleet,
    now: Now,
    window: WindowOf,
    language: LanguageOf,
    use: Annotated[Use | None, Query(description="Only those with this answer: may they be used?")] = None,
    verdict: WantedVerdict = None,
    text: WantedText = None,
    reserved: Annotated[bool | None, Query(description="Only those whose verdict has a reservation, or none.")] = None,
    *,
    due_before: Annotated[Bound | None, Query(description="Only those whose next calibration is due before.")] = None,
    unit_type: Annotated[Sought | None, Query(description="Only those of this type.")] = None,
    stand: Annotated[Sought | None, Query(description="Only those last measured on this stand.")] = None,
    lot: Annotated[Sought | None, Query(description="Only those of this production lot.")] = None,
    flagged: Annotated[bool, Query(description="Only those with an open flag.")] = False,
    location: Annotated[Sought | None, Query(description="Only those at this location.")] = None,
    custodian: Annotated[Sought | None, Query(description="Only those that this custodian has.")] = None,
    uncalibrated: Annotated[bool, Query(description="Only registered units of which no session counts yet.")] = False,
    retired: Annotated[bool | None, Query(description="Only retired units, or units in use.")] = False,
    order: Annotated[Order, Query(description="By use, condition, due date, serial number …")] = USE_FIRST,
    backwards: Annotated[bool, Query(description="The same order, last first.")] = False,
    after: Annotated[Sought | None, Query(description="Only those that come after this serial number.")] = None,
) -> UnitPage:
    """Units, those that may not be used first unless another order is asked for."""
    wanted = FleetQuery(
        use=None if use is None else UseAt(use, now), verdict=verdict, text=text, reserved=reserved,
        offset=window.offset, limit=window.limit,
        due_before=due_before, unit_type=unit_type, stand=stand, lot=lot, flagged=flagged or None,
        location=location, custodian=custodian, uncalibrated=uncalibrated, retired=retired,
        order=order, backwards=backwards, after=after,
    )  # fmt: skip
    found = Fleet(store).units(wanted)
    return UnitPage(
        units=[said_in(unit, language) for unit in units_in_use(store, found, now)], **window.place(len(found))
    )


@router.get(
    "/{serial:path}/history", responses={200: {"content": TABLES}, **errors(404, 422)}, response_model=HistoryPage
)
def read_history(request: Request, serial: Serial, store: Reading, asked: Annotated[HistoryAsked, Query()]) -> Response:
    """The parameters through time, oldest first: value, uncertainty, band, tolerance and verdict of every point.

    A table (CSV, Parquet, Arrow) that is not the last has a `Link` header to the next.
    """
    found = History(store).points(Units(store).key(serial), asked.query)
    form = wanted_form(request, asked.format)
    if form == "json":
        answer = HistoryPage(unit=serial, points=found, **asked.window.place(len(found)))
        return Response(answer.model_dump_json(), media_type="application/json", headers=BY_HEADER)
    table = as_table(history_table(serial, found), form, f"{serial}-history")
    following = asked.window.next_after(len(found))
    if following is not None:
        table.headers["Link"] = f'<{request.url.include_query_params(page=following)}>; rel="next"'
    return table


@router.get("/{serial:path}/flags", responses=errors(404, 422))
def read_flags(
    request: Request, serial: Serial, store: Reading, window: WindowOf, state: WantedState = None
) -> FlagPage:
    """The unit's flags with their lives, open ones first."""
    return flag_page(store, FlagQuery(serial, state), window, asked(request.scope))


@router.get("/{serial:path}/outlook", responses=errors(404, 422))
def read_outlook(
    serial: Serial,
    store: ReadingFleet,
    now: Now,
    reader: ReaderOf,
    until: Annotated[Moment | None, Query(description="Also the risk of waiting until this date.")] = None,
) -> OutlookAnswer:
    """The unit's next calibration and its reason: drift, forecast to tolerance, risk of waiting."""
    reader.until_dated(serial)
    found = outlook_of(store, serial, now)
    risk = None if until is None else found.risk_by(until)
    asked = None if until is None or risk is None else RiskPoint(until, risk)
    return OutlookAnswer(**vars(found), until=asked)


@router.put("/{serial:path}/lot", responses=errors(400, 404, 422))
def change_lot(serial: Serial, new: NewLot, storage: StorageOf, now: Now, person: PersonOf) -> SaidUnit:
    """Record the unit's production lot; a lot that drifts unlike the others is named on the fleet page."""
    return said_unit(set_lot(storage, serial, new.lot or None, now, who=person.signs(CREW)))


@router.get("/{serial:path}/customer", responses=errors(404, 422))
def read_customer(serial: Serial, store: Reading) -> Customer:
    """The customer for whom the unit is calibrated."""
    return Units(store).customer(serial)


@router.put("/{serial:path}/customer", responses=errors(400, 404, 422))
def change_customer(serial: Serial, new: NewCustomer, storage: StorageOf, now: Now, person: PersonOf) -> Customer:
    """Record for whom the unit is calibrated; its certificates name them."""
    customer = Customer(new.name.strip(), new.address.strip())
    return set_customer(storage, serial, customer, now, who=person.signs(new.by))


@router.post("/{serial:path}/recalibrate", responses=errors(404, 422))
def recalibrate_unit(
    serial: Serial, storage: StorageOf, settings: SettingsOf, now: Now, person: PersonOf
) -> Recalibrated:
    """Compute the stored sessions again under the model in force. What was computed before stays readable."""
    k, who = settings.coverage_factor, person.signs("engineer")
    return recalibrate(storage, serial, now, coverage_factor=k, who=who)


@router.get("/{serial:path}", responses=errors(404, 422))
def read_unit(serial: Serial, store: ReadingFleet, now: Now) -> UnitReportSchema:
    """One unit: condition, type, reference, latest sessions, known breaks."""
    report = unit_report(store, serial, now)
    (summary,) = units_in_use(store, (report.summary,), now)
    known = {"summary": summary, "temperatures_covered": covered_now(store, report)}
    return UnitReportSchema.model_validate(vars(report) | known)


@answer
@dataclass(frozen=True)
class UsableAnswer(Usable):
    """Answer to a ground computer: may the unit be used, and its correction."""

    correction: str | None
    """Address of the correction that firmware applies."""


usable_router = APIRouter(prefix="/units", tags=["units"])
NOT_MODIFIED = 304
JSON = TypeAdapter(UsableAnswer)
HELD: dict[int | str, Json] = {
    NOT_MODIFIED: {"description": "The answer that the caller holds is still true, but for `as_of`."}
}


@usable_router.get("/{serial:path}/usable", responses={**HELD, **errors(404, 422)}, response_model=UsableAnswer)
def read_usable(
    request: Request,
    serial: Serial,
    store: Reading,
    now: Now,
    reader: ReaderOf,
    if_none_match: Annotated[str | None, Header(description="The `ETag` of an answer that is held.")] = None,
) -> Response:
    """Whether the unit may be used now, why, and until when; 200 for yes and for no. In doubt the answer is no."""
    reader.until_dated(serial)
    answer = _answer(request, said_in(usable_unit(store, serial, now), asked(request.scope)))
    tag = f'"{sha256(JSON.dump_json(answer, exclude={"as_of"})).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Language"}
    if if_none_match is not None and tag in if_none_match:
        return Response(status_code=NOT_MODIFIED, headers=headers)
    return Response(JSON.dump_json(answer), media_type="application/json", headers=headers)


def _answer(request: Request, found: Usable) -> UsableAnswer:
    """The answer with the address of the correction."""
    link = None if found.correction is None else request.url_for("read_correction", id=found.correction).path
    return UsableAnswer(**{**vars(found), "correction": link})
