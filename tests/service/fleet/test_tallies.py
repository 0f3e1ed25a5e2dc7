"""Facts kept about the fleet as a whole agree with its records, however these came and went."""

from datetime import UTC, datetime
from typing import Any

import pytest
from sqlalchemy import text

from service.flags.changes import resolve_flag
from service.flags.store import Flags
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.changes import withdraw_session
from service.records.diagnose import diagnose
from service.storage import Storage
from service.storage.columns import PARTS
from service.storage.schema import downgrade, upgrade
from service.units.store import Units
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.dated import upload_and_date
from tests.service.made_records import step, way
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
STANDS = ({"id": "S-1"}, {"id": "S-2"})
KEPT = {
    "units": "SELECT severity, is_reference, SUM(units), SUM(flags), SUM(reserved) FROM fleet_tallies WHERE units > 0"
    " GROUP BY severity, is_reference ORDER BY 1, 2",
    "stands": "SELECT st.name, t.sessions, t.units FROM stand_tallies t JOIN stands st ON st.id = t.stand_id"
    " WHERE t.sessions > 0 ORDER BY 1",
}
COUNTED = {
    "units": "SELECT COALESCE(c.severity, -1), COALESCE(s.is_reference, {false}), COUNT(*), SUM(COALESCE(c.flags, 0)),"
    " COUNT(d.reservations) FROM units u LEFT JOIN conditions c ON c.unit_id = u.id"
    " LEFT JOIN sessions s ON s.id = c.last_session LEFT JOIN diagnoses d ON d.session_id = s.id"
    " GROUP BY 1, 2 ORDER BY 1, 2",
    "stands": "SELECT st.name, COUNT(*), COUNT(DISTINCT s.unit_id) FROM sessions s JOIN stands st ON st.id = s.stand_id"
    " WHERE s.state = 'accepted' GROUP BY 1 ORDER BY 1",
}


def answers(storage: Storage, questions: dict[str, str]) -> dict[str, list[tuple[object, ...]]]:
    """Rows of every question."""
    engine = storage.database.engine
    false = "0" if engine.name == "sqlite" else "false"
    with engine.connect() as connection:
        return {
            name: [tuple(row) for row in connection.execute(text(question.format(false=false)))]
            for name, question in questions.items()
        }


def fill(storage: Storage) -> str:
    """Two units on two stands, one of them unfit; the last session."""
    for unit, month, moved in (("A", 1, 0.0), ("B", 1, 0.0), ("A", 3, 200.0), ("B", 3, 0.0)):
        sigmas = dict.fromkeys(("theta_x", "theta_y", "alpha", "beta"), 0.3)
        stand = {**STANDS[month // 3], "alpha_deg": 40.0, "sigma_arcsec": sigmas}
        content = session_bytes(seed=month, month=month, unit=unit, a3_moved=moved, stand=stand)
        last = upload_and_date(storage, content, "a.json", NOW).id
    return last


def test_counts_follow_every_change_of_the_records(storage: Storage) -> None:
    last = fill(storage)
    seen = [answers(storage, KEPT)]
    assert seen[0] == answers(storage, COUNTED)
    diagnose(storage, last, NOW, 2.0)
    with storage.database.reading() as store:
        [flag] = Flags(store).open_of(Units(store).key("A"))
    resolve_flag(storage, flag.id, "K. Ito", "adjusted", NOW)
    assert answers(storage, KEPT) == answers(storage, COUNTED)
    seen.append(answers(storage, KEPT))
    withdraw_session(storage, way(storage), last, step())
    assert answers(storage, KEPT) == answers(storage, COUNTED)
    assert answers(storage, KEPT) != seen[1] != seen[0]


@pytest.mark.slow
def test_a_store_from_before_is_counted_when_it_is_brought_up_to_date(storage: Storage, store_url: str) -> None:
    fill(storage)
    kept = answers(storage, KEPT)
    rates = {"rates": "SELECT unit_id, CAST(rates AS TEXT), reason FROM outlooks ORDER BY 1"}
    before = in_english(answers(storage, rates)["rates"])
    storage.database.close()
    downgrade(store_url, "0018")
    upgrade(store_url)
    assert answers(storage, KEPT) == kept
    assert in_english(answers(storage, rates)["rates"]) == before
    with storage.database.reading() as store:
        assert WorkQueue(store, WorkKind.SUMMARY).count()


def in_english(rows: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    """The rows without the parts of the sentence, which an earlier schema does not keep."""
    return [(*values, reason.partition(PARTS)[0]) for *values, reason in rows]
