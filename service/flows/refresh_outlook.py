"""Step: a unit's outlook is worked out again, within the transaction that changed its history."""

from dataclasses import replace
from datetime import UTC, datetime

from service.judging.forecast import Past, forecast
from service.measures import COVERAGE
from service.storage.store import Store
from service.words.motion import motions_in_words

END_OF_TIME = datetime(9999, 1, 1, tzinfo=UTC)
"""After every break."""


def refresh_outlook(store: Store, serial: str) -> None:
    """Works out a unit's outlook again from the sessions since its last break; within the transaction that writes."""
    unit = store.units.key(serial)
    since, _ = store.services.around(unit, END_OF_TIME)
    last = store.outlooks.last_calibration(unit)
    past = Past(
        serial=serial,
        since=since,
        changes=store.outlooks.changes(unit, since),
        references=store.outlooks.references(unit, since),
        last=None if last is None else last[1],
        longest_days=store.unit_types.of_unit(serial).maximum_interval_days,
    )
    together = () if last is None else motions_in_words(store.sessions.motions(last[0]), COVERAGE)
    store.outlooks.put(unit, replace(forecast(past).outlook, together=tuple(line.text for line in together)))
