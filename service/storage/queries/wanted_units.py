"""Units that are asked for: what narrows the list, and what orders it."""

from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, select

from service.records.fleet import FleetQuery, Order
from service.storage.outlook_tables import OutlookRow
from service.storage.tables import ConditionRow, DiagnosisRow, SessionRow, StandRow, UnitRow, UnitTypeRow

Summaries = Select[UnitRow, str, ConditionRow, SessionRow, DiagnosisRow, datetime | None, str, datetime | None]


def matching(query: Summaries, wanted: FleetQuery) -> Summaries:
    """The wanted units only, in the wanted order."""
    return query.where(*_by_condition(wanted), *_by_date(wanted), *_by_place(wanted)).order_by(*_order(wanted))


def _by_condition(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    said_with = DiagnosisRow.reservations
    found: list[ColumnElement[bool]] = []
    if wanted.verdict is not None:
        found.append(ConditionRow.severity == wanted.verdict.severity)
    if wanted.reserved is not None:
        found.append(said_with.is_not(None) if wanted.reserved else said_with.is_(None))
    if wanted.flagged:
        found.append(ConditionRow.flags > 0)
    return found


def _by_date(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    found: list[ColumnElement[bool]] = [OutlookRow.due.is_(None)] if wanted.undated else []
    return found if wanted.due_before is None else [*found, OutlookRow.due < wanted.due_before]


def _by_place(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    found: list[ColumnElement[bool]] = []
    if wanted.text:
        in_serial = UnitRow.serial.icontains(wanted.text, autoescape=True)
        found.append(in_serial | UnitTypeRow.name.icontains(wanted.text, autoescape=True))
    if wanted.unit_type is not None:
        found.append(UnitTypeRow.name == wanted.unit_type)
    if wanted.stand is not None:
        found.append(SessionRow.stand_id == select(StandRow.id).where(StandRow.name == wanted.stand).scalar_subquery())
    if wanted.lot is not None:
        found.append(UnitRow.lot == wanted.lot)
    return found


def _order(wanted: FleetQuery) -> tuple[ColumnElement[Any], ...]:
    down = wanted.backwards
    by: tuple[ColumnElement[Any], ...] = ()
    if wanted.order is Order.CONDITION:
        worst = ConditionRow.severity.asc() if down else ConditionRow.severity.desc()
        by = (worst, ConditionRow.margin.desc().nulls_first() if down else ConditionRow.margin.asc().nulls_last())
    elif wanted.order is Order.DUE:
        by = (OutlookRow.due.desc().nulls_last() if down else OutlookRow.due.asc().nulls_first(),)
    elif wanted.order is Order.TYPE:
        by = (UnitTypeRow.name.desc() if down else UnitTypeRow.name.asc(),)
    elif wanted.order is Order.LAST:
        by = (SessionRow.started_at.desc() if down else SessionRow.started_at.asc(),)
    last = UnitRow.serial.desc() if down and wanted.order is Order.SERIAL else UnitRow.serial.asc()
    return (*by, last)
