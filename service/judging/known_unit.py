"""Step: what a transaction has read of a unit that it holds, so that nothing is read twice."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import datetime

from estimator.results import Calibration
from service.judging.records import Counted, UnitRecords
from service.judging.reference import alike
from service.judging.store import Derivations
from service.sessions.calibrations_store import Calibrations
from service.sessions.store import Sessions
from service.sessions.words.advice import too_few
from service.storage.store import Store
from service.units.store import epoch

NOTHING_READ: Mapping[tuple[str, int], Calibration] = {}


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
    files: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """Of sessions that are not stored yet."""

    def calibration(self, id: str) -> Calibration:
        """The one in force of a session."""
        if id in self.made:
            return self.made[id]
        if id not in self.read:
            self.read[id] = Calibrations(self.store).get(id)
        return self.read[id]

    def file(self, id: str) -> tuple[str, str]:
        """The hash and the name of a session's file."""
        if id in self.files:
            return self.files[id]
        session = Sessions(self.store).get(id)
        return session.sha256, session.filename

    def read_all(self, ids: Collection[str]) -> None:
        """Reads those of several sessions at once."""
        unread = {*ids} - self.made.keys() - self.read.keys()
        if len(unread) > 1:
            self.read.update(Calibrations(self.store).in_force(unread))

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
    store: Store,
    unit: int,
    made: dict[str, Calibration] | None = None,
    references: Mapping[tuple[str, int], Calibration] = NOTHING_READ,
) -> KnownUnit:
    """A unit as its rows are now, with calibrations that were stored just before, and with those of references that
    were read already, by session and revision."""
    records = Derivations(store).records(unit)
    current = {(one.id, one.revision) for one in records.counted}
    read = {id: found for (id, revision), found in references.items() if (id, revision) in current}
    return KnownUnit(store, unit, records, made or {}, read)
