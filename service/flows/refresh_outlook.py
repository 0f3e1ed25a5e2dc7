"""Step: a unit's outlook is worked out again, within the transaction that changed its history."""

from collections.abc import Iterable
from dataclasses import replace
from datetime import UTC, datetime
from hashlib import sha256

from estimator.health.pooled import learn
from service.judging.forecast import Past, forecast
from service.judging.histories import histories, told_of_type
from service.measures import COVERAGE
from service.storage.history_document import unpacked
from service.storage.store import Store
from service.words.motion import motions_in_words

END_OF_TIME = datetime(9999, 1, 1, tzinfo=UTC)
"""After every break."""
RULE = b"2"
"""Version of what an outlook says of a history: those made by an earlier one are made again."""
TypeHistories = dict[tuple[str, str], tuple[bytes, ...]]
"""What a type's units tell, by kind of sensor and parameter."""


def refresh_outlook(store: Store, serial: str) -> None:
    """Works out a unit's outlook again from the sessions since its last break; within the transaction that writes."""
    unit = store.units.key(serial)
    since, _ = store.services.around(unit, END_OF_TIME)
    known = histories(store.outlooks.changes(unit, since), store.outlooks.references(unit, since))
    store.outlooks.put_histories(unit, told_of_type(known))
    told = of_type(store, unit)
    priors = {place: learn([one for row in rows for one in unpacked(row)]) for place, rows in told.items()}
    last, shown = store.outlooks.last_calibration(unit), store.outlooks.last_session(unit)
    past = Past(
        serial=serial,
        since=since,
        latest=None if last is None else store.sessions.get(last[0]),
        longest_days=store.unit_types.of_unit(serial).maximum_interval_days,
        shown=None if shown is None else store.sessions.get(shown),
    )
    together = () if last is None else motions_in_words(store.sessions.motions(last[0]), COVERAGE)
    outlook = replace(forecast(past, known, priors), rests_on=digest(told))
    store.outlooks.put(unit, replace(outlook, together=tuple(line.text for line in together)))


def of_type(store: Store, unit: int) -> TypeHistories:
    """What the units of a unit's type tell of the parameters that this one has."""
    return {place: store.outlooks.histories(unit, *place) for place in sorted(store.outlooks.places(unit))}


def digest(told: TypeHistories) -> str:
    """64 hexadecimal digits, the same for the same histories."""
    return sha256(RULE + b"".join(_bytes(told))).hexdigest()


def _bytes(told: TypeHistories) -> Iterable[bytes]:
    for place, rows in told.items():
        yield "/".join(place).encode()
        yield from rows
