"""Step: what a transaction has read of a unit that it holds, so that nothing is read twice."""

from collections.abc import Collection
from dataclasses import dataclass, field
from datetime import datetime

from estimator.results import Calibration
from service.judging.reference import alike
from service.records.decision import Judged
from service.records.derivation import Counted, UnitRecords
from service.records.unit import UnitType
from service.storage.queries.services import epoch
from service.storage.store import Store
from service.words.advice import too_few


@dataclass(frozen=True)
class Foreseen:
    """How a new session is judged if nothing changes until its transaction: judging takes longer than storing, and
    nobody else can store meanwhile."""

    basis: str
    """What it was judged by, as its place says."""
    unit_type: UnitType
    judged: Judged
    reference: Counted
    """Which it was judged against."""
    against: Calibration
    """That of the reference, which never changes under one revision."""

    def is_against(self, records: UnitRecords) -> bool:
        """Whether the reference still speaks for the same calibration."""
        own = (self.reference.id, self.reference.revision)
        return any((one.id, one.revision) == own for one in records.counted)


@dataclass(frozen=True)
class KnownUnit:
    """A unit's records, and the calibrations of its sessions that were asked for."""

    store: Store
    unit: int
    records: UnitRecords
    made: dict[str, Calibration] = field(default_factory=dict)
    """Calibrations that this transaction stores: nothing was decided of them before."""
    read: dict[str, Calibration] = field(default_factory=dict)
    """Calibrations in force that it has read."""
    foreseen: Foreseen | None = None
    """Of the only session that it stores."""

    def calibration(self, id: str) -> Calibration:
        """The one in force of a session."""
        if id in self.made:
            return self.made[id]
        if id not in self.read:
            self.read[id] = self.store.calibrations.get(id)
        return self.read[id]

    def read_all(self, ids: Collection[str]) -> None:
        """Reads those of several sessions at once."""
        unread = {*ids} - self.made.keys() - self.read.keys()
        if len(unread) > 1:
            self.read.update(self.store.calibrations.in_force(unread))

    def is_blind(self, one: Counted) -> bool:
        """Whether a session gives no uncertainty; a reference gave one when it was taken for it."""
        return not one.is_reference and bool(too_few(self.calibration(one.id)))

    def reference(self, block: str, programme: str, at: datetime) -> str | None:
        """The session that one of a block, programme and time is judged against."""
        since, until = epoch(self.records.breaks, at)
        return next(
            (
                one.id
                for one in self.records.counted
                if one.is_reference
                and (one.block, one.programme in alike(programme)) == (block, True)
                and (since is None or one.at >= since)
                and (until is None or one.at < until)
            ),
            None,
        )


def known_unit(
    store: Store, unit: int, made: dict[str, Calibration] | None = None, foreseen: Foreseen | None = None
) -> KnownUnit:
    """A unit as its rows are now, with calibrations that were stored just before."""
    known = KnownUnit(store, unit, store.derivations.records(unit), made or {}, foreseen=foreseen)
    if foreseen is not None and foreseen.is_against(known.records):
        known.read[foreseen.reference.id] = foreseen.against
    return known
