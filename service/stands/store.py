"""Common motions by stand, stands' conditions, and the certificates of stands."""

from collections.abc import Sequence
from datetime import date, datetime
from typing import Any

from sqlalchemy import Integer, Select, cast, delete, func, select

from estimator.health.common_motion import BEYOND, SEPARATED
from estimator.json_object import Json
from service.errors import NotFoundError
from service.fleet.tables import ConditionRow
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import CommonMotionRow, SessionRow
from service.stands.records import (
    STILL,
    KnownStand,
    MotionOnStand,
    StandCertificate,
    StandCondition,
    StandError,
    StandUse,
)
from service.stands.tables import StandCertificateRow, StandConditionRow, StandRow, StandTallyRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.types.store import counts_for_stand
from service.units.tables import UnitRow

MOST = 4000
"""Rows, the newest, that stands are judged by."""


class Stands(Queries):
    """Effects of stands on the units measured on them, and the stands' conditions."""

    def last_measured(self, stand: str, since: datetime) -> tuple[str, ...]:
        """Serial numbers of the units whose latest session was on a stand, at a time or later."""
        query = (
            select(UnitRow.serial)
            .join(ConditionRow, ConditionRow.unit_id == UnitRow.id)
            .join(StandRow, StandRow.id == ConditionRow.stand_id)
            .where(StandRow.name == stand, ConditionRow.last_at >= since)
        )
        return tuple(self._session.scalars(query.order_by(UnitRow.serial)))

    def hold(self, stand: str) -> None:
        """Holds a stand until the transaction ends, so that results derived of it are written one after another."""
        self._session.scalar(select(StandRow.id).where(StandRow.name == stand).with_for_update())

    def every(self) -> tuple[KnownStand, ...]:
        """The use of each stand and its own health, by name, in one query."""
        return tuple(_known(*row) for row in self._session.execute(_stands().order_by(StandRow.name)))

    def one(self, stand: str) -> KnownStand:
        """The use and the health of one stand; NotFoundError where there is none of that name."""
        found = self._session.execute(_stands().where(StandRow.name == stand)).one_or_none()
        if found is None:
            raise NotFoundError(
                "There is no stand {stand}: no session was measured on one of that name.", stand=repr(stand)
            )
        return _known(*found)

    def conditions(self) -> tuple[StandCondition, ...]:
        """Every stand's own health as it was last made, by name."""
        query = select(StandConditionRow.document).join(StandRow, StandRow.id == StandConditionRow.stand_id)
        return tuple(STORED.read(StandCondition, doc) for doc in self._session.scalars(query.order_by(StandRow.name)))

    def put_conditions(self, found: Sequence[StandCondition], at: datetime) -> None:
        """Rewrites the conditions of all stands."""
        keys = {name: key for key, name in self._session.execute(select(StandRow.id, StandRow.name))}
        known = [keys[condition.stand] for condition in found]
        self._session.execute(delete(StandConditionRow).where(StandConditionRow.stand_id.not_in(known)))
        for condition in sorted(found, key=lambda condition: keys[condition.stand]):
            values = {"shifts": len(condition.shifts), "document": STORED.written(condition), "made_at": at}
            self._session.merge(StandConditionRow(stand_id=keys[condition.stand], **values))
        self._session.flush()

    def motions(self) -> tuple[MotionOnStand, ...]:
        """The newest common motions on any stand, oldest first, in one query; a reference session's is zero."""
        is_reference = func.sum(cast(SessionRow.is_reference, Integer))
        epoch = is_reference.over(
            partition_by=(SessionRow.unit_id, SessionRow.block), order_by=(SessionRow.started_at, SessionRow.id)
        )
        numbered = select(SessionRow.id, epoch.label("epoch")).where(IS_ACCEPTED).subquery()
        query = (
            select(SessionRow, StandRow.name, UnitRow.serial, numbered.c.epoch, CommonMotionRow)
            .join(StandRow, StandRow.id == SessionRow.stand_id)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(numbered, numbered.c.id == SessionRow.id)
            .outerjoin(
                CommonMotionRow,
                (CommonMotionRow.session_id == SessionRow.id)
                & (CommonMotionRow.revision == SessionRow.revision)
                & CommonMotionRow.state.in_((SEPARATED, BEYOND)),
            )
            .where(
                SessionRow.is_reference | CommonMotionRow.session_id.is_not(None),
                counts_for_stand(StandRow.id.expression),
            )
            .order_by(SessionRow.started_at.desc(), SessionRow.id, CommonMotionRow.kind, CommonMotionRow.quantity)
            .limit(MOST)
        )
        found: list[MotionOnStand] = []
        for session, stand, unit, number, motion in self._session.execute(query):
            found += _motions(session, stand, unit, number, motion)
        return tuple(reversed(found))


def _stands() -> Select[Json | None, str, int, int, datetime | None]:
    """The document of its own health, then the fields of `StandUse`."""
    last = select(func.max(SessionRow.started_at)).where(SessionRow.stand_id == StandRow.id, IS_ACCEPTED)
    counts = (func.coalesce(StandTallyRow.sessions, 0), func.coalesce(StandTallyRow.units, 0))
    return (
        select(StandConditionRow.document, StandRow.name, *counts, last.scalar_subquery())
        .select_from(StandRow)
        .outerjoin(StandTallyRow, StandTallyRow.stand_id == StandRow.id)
        .outerjoin(StandConditionRow, StandConditionRow.stand_id == StandRow.id)
    )


def _known(document: Json | None, *use: Any) -> KnownStand:
    return KnownStand(StandUse(*use), None if document is None else STORED.read(StandCondition, document))


def _motions(
    session: SessionRow, stand: str, unit: str, epoch: int, motion: CommonMotionRow | None
) -> list[MotionOnStand]:
    """One; of a reference one of each quantity, zero by definition."""
    if motion is not None:
        covariance = tuple(map(_tuple, _tuple(motion.covariance)))
        made = (motion.kind, motion.quantity, _tuple(motion.value), covariance)
        return [MotionOnStand(stand, unit, epoch, session.started_at, *made, session.id)]
    return [
        MotionOnStand(stand, unit, epoch, session.started_at, session.block, quantity, *still, session.id)
        for quantity, still in STILL.items()
    ]


def _tuple(stored: Any) -> tuple[Any, ...]:
    """A stored list; empty where something else is stored, which `MotionOnStand.is_whole` says."""
    return tuple(stored) if isinstance(stored, list) else ()


class StandCertificates(Queries):
    """Certificates by stand; a row is written once."""

    def every(self) -> dict[str, tuple[StandCertificate, ...]]:
        """All stands by name, each with its certificates as they were last recorded, oldest issue first."""
        query = (
            select(StandRow.name, StandCertificateRow)
            .outerjoin(StandCertificateRow, StandCertificateRow.stand_id == StandRow.id)
            .order_by(StandRow.name, StandCertificateRow.id)
        )
        found: dict[str, list[StandCertificate]] = {}
        for name, row in self._session.execute(query):
            certificates = found.setdefault(name, [])
            if row is not None:
                certificates.append(certificate_record(name, row))
        return {name: _by_issue(certificates) for name, certificates in found.items()}

    def of_stand(self, stand: str) -> tuple[StandCertificate, ...]:
        """The certificates of one stand as they were last recorded, oldest issue first."""
        return tuple(self.with_errors(stand))

    def with_errors(self, stand: str) -> dict[StandCertificate, tuple[StandError, ...]]:
        """The certificates of a stand, each with the stated errors of the stand: none where it was recorded by hand."""
        query = (
            select(StandCertificateRow)
            .join(StandRow, StandRow.id == StandCertificateRow.stand_id)
            .where(StandRow.name == stand)
            .order_by(StandCertificateRow.id)
        )
        rows = self._session.scalars(query).all()
        recorded = [certificate_record(stand, row) for row in rows]
        errors = {
            certificate: tuple(StandError(name, sigma) for name, sigma in (row.errors or {}).items())
            for certificate, row in zip(recorded, rows, strict=True)
        }
        return {certificate: errors[certificate] for certificate in _by_issue(recorded)}

    def known(self, stand: str) -> tuple[StandCertificate, ...]:
        """The certificates of a stand, by day of issue; NotFoundError where the stand is unknown."""
        self._key(stand)
        return self.of_stand(stand)

    def on(self, stand: str, day: date) -> StandCertificate | None:
        """The latest certificate of a stand that was issued by a day, whether it still held or not."""
        issued = [certificate for certificate in self.of_stand(stand) if certificate.issued_on <= day]
        return issued[-1] if issued else None

    def errors_on(self, stand: str, day: date) -> tuple[StandError, ...]:
        """The errors of the stand as stated by the certificate in force on a day."""
        issued = [errors for certificate, errors in self.with_errors(stand).items() if certificate.issued_on <= day]
        return issued[-1] if issued else ()

    def add(self, new: StandCertificate, who: str, now: datetime, errors: Sequence[StandError] = ()) -> None:
        """Stores a certificate of a stand that is known, with the errors that its document states."""
        stand = self._key(new.stand)
        self.touch(*self._session.scalars(select(ConditionRow.unit_id).where(ConditionRow.stand_id == stand)))
        values = {**vars(new), "stand_id": stand, "who": who, "recorded_at": now}
        values["errors"] = {error.name: error.sigma for error in errors} or None
        del values["stand"]
        self._session.add(StandCertificateRow(**values))
        self._session.flush()

    def _key(self, stand: str) -> int:
        key = self._session.scalar(select(StandRow.id).where(StandRow.name == stand))
        if key is None:
            raise NotFoundError(
                "There is no stand {stand}: no session was measured on one of that name.", stand=repr(stand)
            )
        return key


def _by_issue(recorded: Sequence[StandCertificate]) -> tuple[StandCertificate, ...]:
    """The last recorded certificate of each number, by day of issue; of one day, the last recorded comes last."""
    last = {certificate.number: place for place, certificate in enumerate(recorded)}
    return tuple(sorted((recorded[place] for place in sorted(last.values())), key=lambda c: c.issued_on))


def certificate_record(stand: str, row: StandCertificateRow) -> StandCertificate:
    """A stored certificate of a stand."""
    return StandCertificate(stand, row.number, row.issued_by, row.issued_on, row.valid_until)
