"""Step: how sessions are judged if nothing changes until the transaction that stores them: judging takes longer than
storing, and nobody else can store meanwhile.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import datetime

from estimator.results import Calibration
from service.judging.calibrate import Calibrated
from service.judging.known_unit import KnownUnit, known_unit
from service.judging.records import Counted, UnitRecords
from service.records.derive_again import Deriving
from service.records.epochs import needs_judging
from service.records.judge_again import Foreseen, Judging, judged, judging, places_of
from service.sessions.records import StoredSession
from service.sessions.store import NOT_JUDGED
from service.storage.store import Store
from service.types.rules import type_of
from service.types.store import UnitTypes
from service.units.store import Units

NOTHING_STORED = UnitRecords((), (), (), frozenset(), {}, {})
"""Of a unit that is not known yet."""
NOT_STORED = 0
"""Number of such a unit, under which nothing is found."""


def foresee_upload(store: Store, way: Deriving, new: StoredSession, made: Calibrated, but: str | None) -> Foreseen:
    """The verdict of a session that is to be stored; ``but`` is the session that gives way to it."""
    unit, block = Units(store).find(new.unit), made.checked.session.block
    own = Counted(new.id, block, new.programme, new.started_at, new.revision, is_reference=False, basis=NOT_JUDGED)
    if unit is None:
        known = KnownUnit(store, NOT_STORED, replace(NOTHING_STORED, counted=(own,)), {new.id: made.calibration})
        by = _of_new_unit(store, way, made)
        return judged(known, by, places_of(known))
    known = known_unit(store, unit, {new.id: made.calibration})
    counted = _in_order([one for one in known.records.counted if one.id != but] + [own])
    files = {new.id: (new.sha256, new.filename)}
    known = replace(known, records=replace(known.records, counted=counted), files=files)
    places = [place for place in places_of(known) if place.session.id == new.id]
    return judged(known, judging(known, new.unit, places, way.files, way.coverage_factor, way.at), places)


def foresee_revisions(
    store: Store, way: Deriving, serial: str, made: Mapping[str, tuple[int, Calibration]], since: datetime
) -> Foreseen:
    """The verdicts of a unit under other calibrations of its sessions, by session with the revision of each."""
    known = known_unit(store, Units(store).key(serial), {id: calibration for id, (_, calibration) in made.items()})
    revised = [
        replace(one, revision=made[one.id][0], basis=NOT_JUDGED) if one.id in made else one
        for one in known.records.counted
    ]
    known = replace(known, records=replace(known.records, counted=_in_order(revised)))
    places = needs_judging(places_of(known), since)
    return judged(known, judging(known, serial, places, way.files, way.coverage_factor, way.at), places)


def _of_new_unit(store: Store, way: Deriving, made: Calibrated) -> Judging:
    kind = type_of(made.checked, made.calibration)
    kind = UnitTypes(store).find(kind.name) or kind
    return Judging(way.files, way.coverage_factor, way.at, ((way.at, kind),), {})


def _in_order(sessions: Sequence[Counted]) -> tuple[Counted, ...]:
    return tuple(sorted(sessions, key=lambda one: (one.at, one.id)))
