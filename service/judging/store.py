"""Results derived of a unit's accepted sessions, and the records behind them."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any
from uuid import uuid4

from sqlalchemy import (
    BindParameter,
    ColumnElement,
    CompoundSelect,
    Select,
    Table,
    Update,
    bindparam,
    delete,
    func,
    literal_column,
    null,
    or_,
    select,
    union_all,
    update,
)
from sqlalchemy.orm import Session

from estimator.message import with_messages
from service.diagnosis.tables import DiagnosisRow
from service.flags.records import Concern, FlagState, Matter, NoticeKind
from service.flags.tables import FlagRow, NoticeRow
from service.judging.records import Counted, Decided, FlagEvidence, Key, Moment, SessionEvidence, UnitRecords
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.decision import Judged, Verdict
from service.sessions.records import UNWEIGHED
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED, IS_BREAK
from service.sessions.store import NOT_JUDGED, is_waiting, worst_columns
from service.sessions.tables import CalibrationRow, CommonMotionRow, DecisionRow, ReferenceChoiceRow, SessionRow
from service.stands.tables import StandRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.types.tables import ToleranceRow, UnitTypeRow
from service.units.tables import ServiceRow, UnitRow

UNIT: BindParameter[int] = bindparam("unit")
SESSIONS: Select[*tuple[Any, ...]] = (
    select(
        literal_column("'session'").label("what"), SessionRow.id, SessionRow.block, SessionRow.programme,
        SessionRow.started_at.label("at"), SessionRow.revision.label("number"), SessionRow.is_reference,
        SessionRow.basis, SessionRow.temperature, SessionRow.state, DiagnosisRow.session_id.label("diagnosed"),
        WorkRow.key.label("waiting"),
    )
    .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    .outerjoin(WorkRow, (WorkRow.kind == WorkKind.DIAGNOSIS.value) & (WorkRow.key == SessionRow.id))
    .where(SessionRow.unit_id == UNIT)
)  # fmt: skip
NOTHING = (null(),) * 6
BREAKS: Select[*tuple[Any, ...]] = select(
    literal_column("'break'"), null(), null(), null(), ServiceRow.at, null(), *NOTHING
).where(ServiceRow.unit_id == UNIT, IS_BREAK)
CHOICES: Select[*tuple[Any, ...]] = select(
    literal_column("'choice'"), ReferenceChoiceRow.session_id, null(), null(), ReferenceChoiceRow.at,
    ReferenceChoiceRow.id, *NOTHING,
).where(ReferenceChoiceRow.unit_id == UNIT)  # fmt: skip
LAWS: Select[*tuple[Any, ...]] = (
    select(literal_column("'laws'"), null(), null(), null(), null(), null(), *NOTHING)
    .join_from(UnitRow, UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
    .join(
        ToleranceRow,
        (ToleranceRow.unit_type_id == UnitTypeRow.id) & (ToleranceRow.revision == UnitTypeRow.revision),
    )
    .where(UnitRow.id == UNIT, ToleranceRow.temperature_laws.is_not(None))
)
ALL: CompoundSelect[*tuple[Any, ...]] = union_all(SESSIONS, BREAKS, CHOICES, LAWS)


def unit_records(transaction: Session, unit: int) -> UnitRecords:
    """Read in one statement."""
    rows = transaction.execute(ALL, {"unit": unit}).all()
    sessions, breaks, choices = ([row for row in rows if row.what == kind] for kind in ("session", "break", "choice"))
    accepted = (Counted(*row[1:9]) for row in sessions if row.state == RecordState.ACCEPTED)
    return UnitRecords(
        counted=tuple(sorted(accepted, key=lambda session: (session.at, session.id))),
        breaks=tuple(sorted({row.at for row in breaks})),
        choices=tuple(row.id for row in sorted(choices, key=lambda row: row.number)),
        references=frozenset(row.id for row in sessions if row.is_reference),
        diagnosed={row.id: row.at for row in sessions if row.diagnosed},
        waiting={row.id: row.at for row in sessions if row.waiting},
        has_type_laws=any(row.what == "laws" for row in rows),
    )


class Derivations(Queries):
    """The derived part of sessions."""

    def counted(self, unit: int) -> tuple[Counted, ...]:
        """The accepted sessions of a unit in order of time."""
        query = select(
            SessionRow.id, SessionRow.block, SessionRow.programme, SessionRow.started_at, SessionRow.revision,
            SessionRow.is_reference, SessionRow.basis, SessionRow.temperature,
        ).where(SessionRow.unit_id == unit, IS_ACCEPTED)  # fmt: skip
        rows = self._session.execute(query.order_by(SessionRow.started_at, SessionRow.id))
        return tuple(Counted(*row) for row in rows)

    def records(self, unit: int) -> UnitRecords:
        """Everything that the derived part of a unit rests on, in one statement."""
        return unit_records(self._session, unit)

    def computed_at(self, ids: Collection[str]) -> dict[str, datetime]:
        """The times at which the calibrations in force of some sessions were computed."""
        if not ids:
            return {}
        in_force = (SessionRow.id == CalibrationRow.session_id) & (SessionRow.revision == CalibrationRow.revision)
        query = select(SessionRow.id, CalibrationRow.computed_at).join(CalibrationRow, in_force)
        rows = self._session.execute(query.where(SessionRow.id.in_(ids)))
        return {id: at for id, at in rows}  # noqa: C416 - rows are no pairs

    def put_references(self, unit: int, references: Iterable[str]) -> None:
        """Says which of a unit's sessions others are judged against."""
        wanted = SessionRow.id.in_(tuple(references))
        conditions = (SessionRow.unit_id == unit, SessionRow.is_reference != wanted)
        self._session.execute(update(SessionRow).where(*conditions).values(is_reference=wanted))
        self._session.expire_all()

    def put_revisions(self, revisions: Mapping[str, int]) -> None:
        """Puts the calibrations of sessions under a revision in force; the earlier ones stay stored."""
        new = [{"session": id, "new_revision": revision, "new_basis": NOT_JUDGED} for id, revision in revisions.items()]
        self._session.execute(_REVISED, new)
        self._session.expire_all()

    def wait(self, ids: Collection[str]) -> None:
        """Leaves sessions to be judged later."""
        if not ids:
            return
        self._session.execute(update(SessionRow).where(SessionRow.id.in_(tuple(ids))).values(basis=NOT_JUDGED))
        self._session.expire_all()

    def wait_of_type(self, name: str) -> int:
        """Leaves the accepted sessions of a type's units to be judged again; how many there are."""
        units = select(UnitRow.id).join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        condition = SessionRow.unit_id.in_(units.where(UnitTypeRow.name == name)), IS_ACCEPTED
        waiting = update(SessionRow).where(*condition).values(basis=NOT_JUDGED).returning(SessionRow.id)
        found = len(self._session.scalars(waiting).all())
        self._session.expire_all()
        return found

    def waiting(self) -> tuple[str, ...]:
        """Serial numbers of units with accepted sessions that are to be judged or weighed."""
        query = select(UnitRow.serial).join(SessionRow, SessionRow.unit_id == UnitRow.id)
        query = query.where(is_waiting(SessionRow.basis), IS_ACCEPTED)
        return tuple(self._session.scalars(query.distinct().order_by(UnitRow.serial)))

    def waiting_of(self, serial: str) -> int:
        """The number of accepted sessions of a unit that are to be judged or weighed."""
        query = select(func.count()).select_from(SessionRow).join(UnitRow, UnitRow.id == SessionRow.unit_id)
        conditions = (UnitRow.serial == serial, is_waiting(SessionRow.basis), IS_ACCEPTED)
        return self._session.scalar(query.where(*conditions)) or 0

    def put_weighed(self, ids: Collection[str]) -> None:
        """Marks the verdicts of sessions as weighed beside their diagnoses."""
        conditions = SessionRow.id.in_(tuple(ids)), SessionRow.basis.startswith(UNWEIGHED)
        weighed = func.substr(SessionRow.basis, len(UNWEIGHED) + 1)
        self._session.execute(update(SessionRow).where(*conditions).values(basis=weighed))
        self._session.expire_all()

    def put_judged(self, decided: Sequence[Decided]) -> None:
        """Stores the decisions on sessions under their revisions, in place of the earlier ones; the calibrations
        stay.
        """
        if not decided:
            return
        again = [d.session for d in decided if not d.is_first]
        for table in (DecisionRow, CommonMotionRow) if again else ():
            in_force = select(SessionRow.revision).where(SessionRow.id == table.session_id).scalar_subquery()
            self._session.execute(delete(table).where(table.session_id.in_(again), table.revision == in_force))
        self._session.execute(_JUDGED, [_judged(d) for d in decided])
        self._session.execute(_JUDGED_UNDER, [_judged_under(d) for d in decided])
        self.insert_many(DecisionRow, [row for d in decided for row in _decision_rows(d)])
        self.insert_many(CommonMotionRow, [row for d in decided for row in _motion_rows(d)])
        self._session.expire_all()

    def keep_evidence(self, id: str, evidence: FlagEvidence) -> None:
        """Keeps what the diagnosis of a session says for flags."""
        query = update(DiagnosisRow).where(DiagnosisRow.session_id == id)
        self._session.execute(query.values(tells=evidence_to_dict(evidence)))
        self._session.expire_all()

    def evidence(self, unit: int) -> tuple[SessionEvidence, ...]:
        """The evidence of every accepted session of a unit, in order of time."""
        return tuple(
            SessionEvidence(
                (at, id), serial, _evidence(verdict), _diagnosis_evidence(diagnosis, is_undecided), basis is None
            )
            for at, id, serial, verdict, diagnosis, is_undecided, basis in self._session.execute(
                _EVIDENCE, {"unit": unit}
            )
        )

    def evidence_on_stand(self, stand: str) -> tuple[SessionEvidence, ...]:
        """The evidence of the diagnoses of the newest accepted sessions on a stand, oldest first."""
        found = self._session.execute(_EVIDENCE_OF_STAND, {"stand": stand}).all()
        return tuple(
            SessionEvidence((at, id), unit, None, _diagnosis_evidence(diagnosis, is_undecided), block=block)
            for at, id, diagnosis, is_undecided, unit, block in reversed(found)
        )

    def settled(self, unit: int, by_service: str) -> dict[Key, Moment]:
        """The last session of each flag that a person resolved, by matter and place."""
        return self._settled(by_service, FlagRow.unit_id == unit)

    def settled_of_stand(self, stand: str, by_service: str) -> Moment | None:
        """The last session of the flags on a stand from diagnoses that persons resolved; None where none was
        resolved.
        """
        settled = self._settled(by_service, FlagRow.matter == Matter.STAND, FlagRow.place == stand)
        return settled.get((Matter.STAND, stand))

    def _settled(self, by_service: str, *conditions: ColumnElement[bool]) -> dict[Key, Moment]:
        by_person = select(NoticeRow.flag_id).where(NoticeRow.kind == NoticeKind.RESOLVED, NoticeRow.who != by_service)
        query = select(FlagRow.matter, FlagRow.place, SessionRow.started_at, SessionRow.id).join(
            SessionRow, SessionRow.id == FlagRow.session_id
        )
        query = query.where(*conditions, FlagRow.state == FlagState.RESOLVED, FlagRow.id.in_(by_person))
        found: dict[Key, Moment] = {}
        for matter, place, at, id in self._session.execute(query):
            found[matter, place] = max(found.get((matter, place), (at, id)), (at, id))
        return found

    def forget_diagnoses(self, unit: int, since: datetime, but: Iterable[str]) -> tuple[str, ...]:
        """Diagnoses from a date on looked at what has changed since: they are to be made again; all but some."""
        self.touch(unit)
        later = select(SessionRow.id).where(
            SessionRow.unit_id == unit, SessionRow.started_at >= since, SessionRow.id.not_in(tuple(but))
        )
        gone = delete(DiagnosisRow).where(DiagnosisRow.session_id.in_(later)).returning(DiagnosisRow.session_id)
        return tuple(sorted(self._session.scalars(gone)))

    def look_again(self, unit: int, since: datetime, judged: Collection[str]) -> None:
        """Diagnoses that are being made, from a date on or of some sessions, are made again with what has changed."""
        concerned = select(SessionRow.id).where(
            SessionRow.unit_id == unit, or_(SessionRow.started_at >= since, SessionRow.id.in_(judged))
        )
        conditions = (WorkRow.kind == WorkKind.DIAGNOSIS, WorkRow.key.in_(concerned))
        self._session.execute(update(WorkRow).where(*conditions).values(ticket=uuid4().hex))

    def forget_diagnosis(self, id: str) -> tuple[str, ...]:
        """Deletes the diagnosis of one session; returns its id, or none where it has none."""
        gone = delete(DiagnosisRow).where(DiagnosisRow.session_id == id).returning(DiagnosisRow.session_id)
        return tuple(self._session.scalars(gone))


def _changed(table: type[SessionRow] | type[CalibrationRow], *names: str) -> Update:
    core_table = table.__table__
    assert isinstance(core_table, Table)
    return update(core_table).values({name: bindparam(f"new_{name}") for name in names})


MOST_OF_STAND = 500
"""The newest sessions that count for a stand: of months where it is used every hour."""
_IS_UNDECIDED = (SessionRow.verdict == Verdict.UNDECIDABLE) & ~SessionRow.is_reference
_EVIDENCE = (
    select(
        SessionRow.started_at, SessionRow.id, UnitRow.serial, SessionRow.tells, DiagnosisRow.tells, _IS_UNDECIDED,
        SessionRow.basis,
    )
    .join(UnitRow, UnitRow.id == SessionRow.unit_id)
    .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    .where(SessionRow.unit_id == bindparam("unit"), IS_ACCEPTED)
    .order_by(SessionRow.started_at, SessionRow.id)
)  # fmt: skip
_EVIDENCE_OF_STAND = (
    select(SessionRow.started_at, SessionRow.id, DiagnosisRow.tells, _IS_UNDECIDED, UnitRow.serial, SessionRow.block)
    .join(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    .join(UnitRow, UnitRow.id == SessionRow.unit_id)
    .join(StandRow, StandRow.id == SessionRow.stand_id)
    .where(StandRow.name == bindparam("stand"), IS_ACCEPTED)
    .order_by(SessionRow.started_at.desc(), SessionRow.id.desc())
    .limit(MOST_OF_STAND)
)
_SUMMARY = ("verdict", "reason", "worst_sensor", "worst_parameter", "margin")
_JUDGED = _changed(SessionRow, *_SUMMARY, "basis", "tells").where(SessionRow.id == bindparam("session"))
_REVISED = _changed(SessionRow, "revision", "basis").where(SessionRow.id == bindparam("session"))
_JUDGED_UNDER = _changed(CalibrationRow, *_SUMMARY).where(
    CalibrationRow.session_id == bindparam("session"), CalibrationRow.revision == bindparam("under")
)


def _summary(judged: Judged) -> dict[str, Any]:
    summary = {"verdict": judged.verdict, "reason": judged.reason, **worst_columns(judged.worst)}
    return {f"new_{name}": value for name, value in summary.items()}


def _judged(decided: Decided) -> dict[str, Any]:
    tells = None if decided.evidence is None else evidence_to_dict(decided.evidence)
    return {"session": decided.session, "new_basis": decided.basis, "new_tells": tells, **_summary(decided.judged)}


def _judged_under(decided: Decided) -> dict[str, Any]:
    return {"session": decided.session, "under": decided.revision, **_summary(decided.judged)}


def _decision_rows(decided: Decided) -> Iterator[dict[str, Any]]:
    key = {"session_id": decided.session, "revision": decided.revision}
    for position, decision in enumerate(decided.judged.decisions):
        taken = decision.temperature_correction
        kept = {"guard_band": decision.guard_band, "temperature_correction": None if taken is None else vars(taken)}
        yield {**key, "position": position, **vars(decision), **kept}


def _motion_rows(decided: Decided) -> Iterator[dict[str, Any]]:
    for motion in decided.judged.motions:
        yield {"session_id": decided.session, "revision": decided.revision, **vars(motion)}


def evidence_to_dict(evidence: FlagEvidence) -> dict[str, list[list[Any]]]:
    """The evidence as it is stored."""
    concerns = [
        [c.matter.value, c.place, c.severity, c.summary, *([c.causes, c.sensors] if c.causes else [])]
        for c in evidence.concerns
    ]
    document: dict[str, list[list[Any]]] = STORED.written({"concerns": concerns, "clear": evidence.clear})
    return document


def _diagnosis_evidence(document: dict[str, list[list[Any]]] | None, is_undecided: bool) -> FlagEvidence | None:
    """The evidence of a diagnosis: a session too coarse to decide does not show that something is gone."""
    evidence = _evidence(document)
    return evidence if evidence is None or not is_undecided else FlagEvidence(evidence.concerns, ())


def _evidence(document: dict[str, list[list[Any]]] | None) -> FlagEvidence | None:
    if document is None:
        return None
    concerns = tuple(_concern(*concern) for concern in document["concerns"])
    clear = tuple((str(matter), str(place), with_messages(why)) for matter, place, why in document["clear"])
    return FlagEvidence(concerns, clear)


def _concern(
    matter: str, place: str, severity: int, summary: Any, causes: Sequence[str] = (), sensors: Sequence[list[str]] = ()
) -> Concern:
    return Concern(
        Matter(matter),
        place,
        severity,
        with_messages(summary),
        causes=tuple(causes),
        sensors=tuple((name, kind) for name, kind in sensors),
    )
