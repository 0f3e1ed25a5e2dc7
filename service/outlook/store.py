"""Outlooks, one a unit, the changes that they are made of, and those still to be worked out."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime

import numpy as np
from sqlalchemy import ColumnElement, Row, Select, delete, func, or_, select

from estimator.health.error_laws import FREEDOMS
from estimator.health.fits import PART_KINDS, PARTS, WALKS
from estimator.health.pooled import Evidence
from estimator.health.shapes import Kind
from estimator.health.temperature_law import FOLLOW
from estimator.json_object import Json
from estimator.session import IN_SERVICE
from service.kit.copying import copied
from service.outlook.populations import Placed, Population
from service.outlook.records import DueDate, ParameterTrend, Rate, UnitOutlook
from service.outlook.tables import HistoryRow, OutlookRow, PopulationRow
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import MOVES_DATES, DecisionRow, ParameterRow, SessionRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.types.store import counts_for_type
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow


def outlook_to_dicts(outlook: UnitOutlook) -> tuple[Json, Json]:
    """The outlook as two documents that `outlook_from_dicts` reads; times are ISO 8601."""
    written: Json = STORED.written(outlook)
    fans = [trend.pop("fan") for trend in written["trends"]]
    return written, {"risk": written.pop("risk"), "fans": fans}


def outlook_from_dicts(document: Json, drawn: Json | None = None) -> UnitOutlook:
    """The outlook from its documents; without its fans and its risk where ``drawn`` was left in the store."""
    if drawn is None:
        return STORED.read(UnitOutlook, document)
    trends = [trend | {"fan": fan} for trend, fan in zip(document["trends"], drawn["fans"], strict=True)]
    return STORED.read(UnitOutlook, document | {"trends": trends, "risk": drawn["risk"]})


SHAPE = (len(WALKS), len(PARTS))
"""Shape of the log evidence of one history."""
LAWS = len(FREEDOMS)
MARK = np.full(1, -np.inf, dtype="<f4")
"""Rows behind a positive one were written before temperature was distinguished from drifts; those behind a NaN, which
hold tails, and those behind nothing before aging that comes to an end was distinguished from aging that goes on."""
WARM = int(np.count_nonzero(PART_KINDS == Kind.WARMTH))
EARLIER, EARLIEST = SHAPE[1] - WARM, SHAPE[1] - WARM - 2
"""Parts of the log evidence of those."""


def packed(histories: Sequence[Evidence]) -> bytes:
    """Packs histories for `unpacked`; logs relative to their largest, which suffices for learning."""
    rows = [np.concatenate([[h.span], h.log_tails, (h.log_evidence - h.log_evidence.max()).ravel()]) for h in histories]
    return MARK.tobytes() + np.asarray(rows, dtype="<f4").tobytes()


def unpacked(content: bytes) -> tuple[Evidence, ...]:
    """The histories that were written."""
    numbers = np.frombuffer(content, dtype="<f4").astype(float)
    is_marked = not np.isfinite(numbers[:1]).all()
    parts = SHAPE[1] if np.isneginf(numbers[:1]).any() else EARLIER if np.isinf(numbers[:1]).any() else EARLIEST
    laws = LAWS if is_marked else 0
    rows = numbers[is_marked:].reshape(-1, 1 + laws + SHAPE[0] * parts)
    tails = rows[:, 1 : 1 + laws] if laws else np.zeros((len(rows), LAWS))
    evidence = rows[:, 1 + laws :].reshape(-1, SHAPE[0], parts)
    if parts == EARLIEST:  # of which end was open: as likely by one as by the other
        evidence = np.concatenate([evidence, evidence[..., -2:]], axis=2)
    if parts != SHAPE[1]:  # of temperature they tell nothing: as likely with it as without
        evidence = np.concatenate([evidence, np.repeat(evidence[..., :1], WARM, axis=2)], axis=2)
    return tuple(
        Evidence(float(row[0]), *rest) for row, rest in zip(rows, zip(evidence, tails, strict=True), strict=True)
    )


MOST_UNITS = 60
"""Most units whose histories a type is learned from: hundreds of parameters, which no further unit changes much."""


@dataclass(frozen=True)
class ChangeRow:
    """One parameter of one sensor at one session, as it was judged."""

    at: datetime
    block: str
    programme: str
    sensor: str
    kind: str
    parameter: str
    tolerance: float
    change: list[float]
    own: list[float]
    origin: list[float]
    dof: float | None
    """Degrees of freedom of the uncertainty; None where all noise is known."""
    temperature: float | None
    """°C"""
    value: float | None = None
    """Measured value; None for an axis."""
    reference: float | None = None
    u: float | None = None
    """Standard uncertainty of the value."""
    session: str = ""


@dataclass(frozen=True)
class ReferenceRow:
    """A session that others are judged against."""

    at: datetime
    block: str
    programme: str
    temperature: float | None
    """°C"""
    session: str = ""
    u: Mapping[tuple[str, str], float] = field(default_factory=dict)
    """Standard uncertainties of its values that follow the temperature, by sensor and parameter."""


OWN = (
    (ParameterRow.session_id == DecisionRow.session_id)
    & (ParameterRow.revision == DecisionRow.revision)
    & (ParameterRow.sensor == DecisionRow.sensor)
    & (ParameterRow.parameter == DecisionRow.parameter)
)
"""The measured parameter that a decision is on."""


class Outlooks(Queries):
    """Outlooks of units and the histories behind them."""

    def changes(self, unit: int, since: datetime | None) -> tuple[ChangeRow, ...]:
        """Every judged change of a unit since a time, oldest first; not those of a recording in service or a check."""
        query = (
            select(
                SessionRow.started_at, SessionRow.block, SessionRow.programme, DecisionRow.sensor, DecisionRow.kind,
                DecisionRow.parameter, DecisionRow.tolerance, DecisionRow.change, DecisionRow.change_own,
                DecisionRow.change_origin, DecisionRow.dof, SessionRow.temperature, DecisionRow.value,
                DecisionRow.reference, ParameterRow.u, SessionRow.id,
            )
            .join(DecisionRow, DecisionRow.session_id == SessionRow.id)
            .outerjoin(ParameterRow, OWN)
            .where(DecisionRow.revision == SessionRow.revision, DecisionRow.change.is_not(None))
        )  # fmt: skip
        order = (SessionRow.started_at, SessionRow.id, DecisionRow.position)
        query = query.where(*_within(unit, since), MOVES_DATES).order_by(*order)
        found = self._session.execute(query)
        return tuple(ChangeRow(*row) for row in found)

    def references(self, unit: int, since: datetime | None) -> tuple[ReferenceRow, ...]:
        """The sessions since a time that others are judged against, oldest first."""
        of_session = (ParameterRow.session_id == SessionRow.id) & (ParameterRow.revision == SessionRow.revision)
        query = select(
            SessionRow.id, SessionRow.started_at, SessionRow.block, SessionRow.programme, SessionRow.temperature,
            ParameterRow.sensor, ParameterRow.parameter, ParameterRow.u,
        ).outerjoin(ParameterRow, of_session & ParameterRow.parameter.in_(FOLLOW))  # fmt: skip
        order = (SessionRow.started_at, SessionRow.id)
        rows = self._session.execute(query.where(SessionRow.is_reference, *_within(unit, since)).order_by(*order))
        found: dict[str, ReferenceRow] = {}
        known: dict[str, dict[tuple[str, str], float]] = {}
        for id, at, block, programme, warm, sensor, parameter, u in rows:
            u_of = known.setdefault(id, {})
            found.setdefault(id, ReferenceRow(at, block, programme, warm, id, u_of))
            if u is not None:
                u_of[sensor, parameter] = u
        return tuple(found.values())

    def last_calibration(self, unit: int) -> tuple[str, datetime] | None:
        """The session that last measured the unit, recordings in service and checks apart, and when."""
        newest = _newest(unit).where(SessionRow.programme != IN_SERVICE, MOVES_DATES)
        found = self._session.execute(newest).one_or_none()
        return None if found is None else (found[0], found[1])

    def last_session(self, unit: int) -> str | None:
        """The unit's latest session, recordings in service too."""
        found = self._session.execute(_newest(unit)).one_or_none()
        return None if found is None else found[0]

    def put(self, unit: int, outlook: UnitOutlook) -> None:
        """Rewrites a unit's outlook."""
        self.touch(unit)
        document, drawn = outlook_to_dicts(outlook)
        read = {"due": outlook.due, "reason": outlook.reason, "rates": [_rate(trend) for trend in outlook.trends]}
        self._session.merge(OutlookRow(unit_id=unit, document=document, drawn=drawn, **read))
        self._session.flush()

    def drop(self, unit: int) -> None:
        """Deletes the outlook of a unit without an accepted session."""
        self.touch(unit)
        self._session.execute(delete(OutlookRow).where(OutlookRow.unit_id == unit))
        self._session.execute(delete(HistoryRow).where(HistoryRow.unit_id == unit))

    def put_histories(self, unit: int, evidence: Mapping[tuple[str, str], Sequence[Evidence]]) -> None:
        """Rewrites the evidence of a unit's histories for its type, by kind of sensor and parameter."""
        self._session.execute(delete(HistoryRow).where(HistoryRow.unit_id == unit))
        self._session.add_all(
            HistoryRow(unit_id=unit, kind=kind, parameter=parameter, evidence=packed(histories))
            for (kind, parameter), histories in evidence.items()
        )
        self._session.flush()

    def histories(self, unit: int, kind: str, parameter: str) -> tuple[bytes, ...]:
        """Packed histories of one parameter for the units of a unit's type, by serial number; at most `MOST_UNITS`."""
        type_id = select(UnitRow.unit_type_id).where(UnitRow.id == unit).scalar_subquery()
        query = (
            select(HistoryRow.evidence)
            .join(UnitRow, UnitRow.id == HistoryRow.unit_id)
            .where(UnitRow.unit_type_id == type_id, HistoryRow.kind == kind, HistoryRow.parameter == parameter)
        )
        return tuple(self._session.scalars(query.order_by(UnitRow.serial).limit(MOST_UNITS)))

    def places(self, unit: int) -> tuple[tuple[str, str], ...]:
        """Kinds of sensor and parameters that a unit has histories of."""
        query = select(HistoryRow.kind, HistoryRow.parameter).where(HistoryRow.unit_id == unit)
        return tuple((kind, parameter) for kind, parameter in self._session.execute(query))

    def rests_on(self, unit: int) -> str:
        """The hash of the type's histories behind a unit's outlook; empty where there is none."""
        row = self._session.get(OutlookRow, unit)
        return "" if row is None else str(row.document["rests_on"])

    def of_unit(self, serial: str) -> UnitOutlook | None:
        """The outlook of one unit; None before its first session is judged."""
        query = _outlooks().where(UnitRow.serial == serial)
        row = self._session.execute(query).one_or_none()
        return None if row is None else outlook_of(*row)

    def rates(self, unit_type: int) -> tuple[Rate, ...]:
        """Every drift of a type's units, in one query."""
        query = (
            select(UnitTypeRow.name, UnitRow.lot, UnitRow.serial, OutlookRow.rates)
            .join(UnitRow, UnitRow.id == OutlookRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(UnitTypeRow.id == unit_type, counts_for_type(unit_type))
            .order_by(UnitRow.serial)
        )
        return tuple(
            Rate(of_type, lot, serial, *rate)
            for of_type, lot, serial, rates in self._session.execute(query)
            for rate in rates
        )

    def overdue(self, now: datetime) -> int:
        """The number of units whose calibration is overdue."""
        return self._session.scalar(overdue_count(now)) or 0

    def overdue_units(self, now: datetime) -> tuple[str, ...]:
        """Serial numbers of the units that should have been calibrated by now."""
        return tuple(self._session.scalars(_overdue(now).with_only_columns(UnitRow.serial).order_by(UnitRow.serial)))

    def due(self, most: int, since: datetime | None = None) -> tuple[DueDate, ...]:
        """The due dates of units with their reasons, the first to come first; overdue ones before all."""
        query = select(UnitRow.serial, OutlookRow.due, OutlookRow.reason)
        query = query.join(UnitRow, UnitRow.id == OutlookRow.unit_id).where(
            OutlookRow.due.is_not(None), UnitRow.retired_at.is_(None)
        )
        if since is not None:
            query = query.where(OutlookRow.due >= since)
        rows = self._session.execute(query.order_by(OutlookRow.due, OutlookRow.unit_id).limit(most))
        return tuple(DueDate(unit, at, reason) for unit, at, reason in rows if at is not None)


def _overdue(now: datetime) -> Select[int]:
    """Units in use that should have been calibrated by now."""
    query = select(UnitRow.id).join(OutlookRow, OutlookRow.unit_id == UnitRow.id)
    return query.where(OutlookRow.due < now, UnitRow.retired_at.is_(None))


def overdue_count(now: datetime) -> Select[int]:
    """The query for the number of overdue units."""
    return select(func.count()).select_from(_overdue(now).subquery())


def _within(unit: int, since: datetime | None) -> list[ColumnElement[bool]]:
    conditions = [SessionRow.unit_id == unit, IS_ACCEPTED]
    return conditions if since is None else [*conditions, SessionRow.started_at >= since]


def _newest(unit: int) -> Select[str, datetime]:
    sessions = select(SessionRow.id, SessionRow.started_at).where(*_within(unit, None))
    return sessions.order_by(SessionRow.started_at.desc(), SessionRow.id.desc()).limit(1)


def _outlooks() -> Select[OutlookRow, str | None, str]:
    return (
        select(OutlookRow, UnitRow.lot, UnitTypeRow.name)
        .join(UnitRow, UnitRow.id == OutlookRow.unit_id)
        .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
    )


def _rate(trend: ParameterTrend) -> list[str | float]:
    """The fields of `Rate` after those of the unit, in tolerances a year."""
    value, sigma = trend.rate_per_year / trend.tolerance, trend.rate_sigma / trend.tolerance
    return [trend.sensor, trend.kind, trend.parameter, value, sigma, trend.significance, trend.tolerance]


def outlook_of(row: OutlookRow, lot: str | None, unit_type: str) -> UnitOutlook:
    """A stored outlook, with what only a unit's page draws."""
    return replace(outlook_from_dicts(row.document, row.drawn), lot=lot, unit_type=unit_type)


@dataclass(frozen=True)
class FarOut:
    """The populations with the furthest units and lots, and among how many these are."""

    populations: tuple[Population, ...]
    rates: int
    lots: int


class Populations(Queries):
    """Centre and spread of every parameter's rates, by type."""

    def put(self, unit_type: int, found: Sequence[Population], at: datetime) -> None:
        """Rewrites the populations of a type."""
        self._session.execute(delete(PopulationRow).where(PopulationRow.unit_type_id == unit_type))
        self._session.add_all(_row(unit_type, population, at) for population in found)
        self._session.flush()

    def of_type(self, name: str) -> tuple[Population, ...]:
        """The populations of a type, one a parameter."""
        rows = self._session.execute(_populations().where(UnitTypeRow.name == name))
        return tuple(_population(row) for row in rows)

    def furthest(self, most: int) -> FarOut:
        """At most ``most`` populations with the furthest units, and as many with the furthest lots."""
        table = PopulationRow
        far, lots = (
            select(column).where(column > 0).order_by(column.desc()).offset(most - 1).limit(1).scalar_subquery()
            for column in (table.furthest, table.furthest_lot)
        )
        among = (func.coalesce(select(func.sum(column)).scalar_subquery(), 0) for column in (table.rates, table.lots))
        query = (
            _populations()
            .add_columns(*among)
            .where(
                or_(
                    (table.furthest > 0) & (table.furthest >= func.coalesce(far, 0.0)),
                    (table.furthest_lot > 0) & (table.furthest_lot >= func.coalesce(lots, 0.0)),
                )
            )
        )
        rows = self._session.execute(query.order_by(table.unit_type_id, table.kind, table.parameter)).all()
        rates, lots_in_all = rows[0][2:] if rows else (0, 0)
        return FarOut(tuple(_population(row[:2]) for row in rows), rates, lots_in_all)

    def most_evident(self, most: int) -> tuple[Population, ...]:
        """At most ``most`` populations with the units that are furthest out beyond chance, the furthest first."""
        query = _populations().where(PopulationRow.most_evident > 0)
        order = (PopulationRow.most_evident.desc(), PopulationRow.unit_type_id, PopulationRow.kind)
        rows = self._session.execute(query.order_by(*order, PopulationRow.parameter).limit(most))
        return tuple(_population(row) for row in rows)


def _populations() -> Select[PopulationRow, str]:
    return select(PopulationRow, UnitTypeRow.name).join(UnitTypeRow, UnitTypeRow.id == PopulationRow.unit_type_id)


def _row(unit_type: int, population: Population, at: datetime) -> PopulationRow:
    return PopulationRow(
        unit_type_id=unit_type,
        kind=population.kind,
        parameter=population.parameter,
        centre=population.centre,
        spread=population.spread,
        rates=population.rates,
        lots=population.lots,
        furthest=max((abs(placed.z) for placed in population.fast), default=0.0),
        furthest_lot=max((abs(z) for _, z in population.far_lots), default=0.0),
        most_evident=max((abs(placed.z) for placed in population.evident), default=0.0),
        far={
            "fast": [asdict(placed) for placed in population.fast],
            "evident": [asdict(placed) for placed in population.evident],
            "lots": [list(lot) for lot in population.far_lots],
        },
        made_at=at,
    )


def _population(found: Row[PopulationRow, str] | Sequence[object]) -> Population:
    row, unit_type = found
    assert isinstance(row, PopulationRow)
    return copied(
        Population,
        row,
        unit_type=str(unit_type),
        fast=tuple(Placed(**placed) for placed in row.far["fast"]),
        evident=tuple(Placed(**placed) for placed in row.far["evident"]),
        far_lots=tuple((name, z) for name, z in row.far["lots"]),
    )
