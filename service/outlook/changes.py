"""Step: the sources of a unit's outlook, read from the store → the outlook, computed while no transaction is open."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import lru_cache
from hashlib import sha256

from estimator.health.pooled import Prior, learn
from service.kit.lock_order import outside_writing
from service.kit.measures import COVERAGE
from service.outlook.explained import left_of
from service.outlook.records import UnitOutlook
from service.outlook.rules.forecast import Past, forecast
from service.outlook.rules.histories import Histories, histories
from service.outlook.store import Outlooks, unpacked
from service.outlook.words import explained_in_words
from service.sessions.store import Sessions
from service.sessions.words.motion import motions_in_words
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.store import Services, Units

END_OF_TIME = datetime(9999, 1, 1, tzinfo=UTC)
"""A time after every break."""
RULE = b"6"
"""Version of the rules of outlooks: those made by an earlier one are made again."""
AT_HAND = 32
"""Parameters whose prior is kept: those of several types. Units are worked out again type by type."""
TypeHistories = dict[tuple[str, str], tuple[bytes, ...]]
"""Packed histories of the type's units, by kind of sensor and parameter."""


@dataclass(frozen=True)
class Sources:
    """Sources of a unit's outlook."""

    past: Past
    known: Histories
    """Histories of the unit."""
    histories: TypeHistories
    together: tuple[str, ...]
    """Motions common to all sensors, and the parts of the latest changes that a diagnosis explains, in words."""


def known_of(store: Store, serial: str) -> Histories:
    """The histories of a unit since its last break."""
    unit = Units(store).key(serial)
    since = Services(store).began(unit, END_OF_TIME)
    changes, references = Outlooks(store).changes(unit, since), Outlooks(store).references(unit, since)
    return histories(changes, references, left_of(store, serial, changes, references))


def gathered(store: Store, serial: str, known: Histories) -> Sources:
    """Everything that a unit's outlook is worked out from; what the unit contributes to its type is kept already."""
    unit = Units(store).key(serial)
    since = Services(store).began(unit, END_OF_TIME)
    last, shown = Outlooks(store).last_calibration(unit), Outlooks(store).last_session(unit)
    past = Past(
        serial=serial,
        since=since,
        latest=None if last is None else Sessions(store).get(last[0]),
        longest_days=UnitTypes(store).of_unit(serial).maximum_interval_days,
        shown=None if shown is None else Sessions(store).get(shown),
    )
    together = () if last is None else motions_in_words(Sessions(store).motions(last[0]), COVERAGE)
    said = tuple(line.text for line in together)
    if past.latest is not None:
        parts = known.explained_in(past.latest.id)
        said += (explained_in_words(past.latest.started_at, parts),) if parts else ()
    return Sources(past, known, of_type(store, unit), said)


@outside_writing
def worked_out(sources: Sources) -> UnitOutlook:
    """The numerical part, with no store at hand."""
    histories = sources.histories
    priors = {place: learned(rows) for place, rows in histories.items()}
    outlook = forecast(sources.past, sources.known, priors)
    return replace(outlook, rests_on=digest(histories), together=sources.together)


@lru_cache(maxsize=AT_HAND)
def learned(rows: tuple[bytes, ...]) -> Prior:
    """The prior of a parameter from the histories of a type's units. It is the same for most units of a large type."""
    return learn([item for row in rows for item in unpacked(row)])


def of_type(store: Store, unit: int) -> TypeHistories:
    """The histories of the type's units for each parameter of the unit."""
    return {place: Outlooks(store).histories(unit, *place) for place in sorted(Outlooks(store).places(unit))}


def digest(histories: TypeHistories) -> str:
    """The digest of histories, 64 hexadecimal digits."""
    return sha256(RULE + b"".join(_bytes(histories))).hexdigest()


def _bytes(histories: TypeHistories) -> Iterable[bytes]:
    for place, rows in histories.items():
        yield "/".join(place).encode()
        yield from rows
