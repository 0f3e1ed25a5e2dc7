"""All background work has one order: what somebody looks at, what somebody uploaded, what rests on many sessions, and
the demonstration at last."""

from datetime import UTC, datetime, timedelta
from threading import Event

import pytest

from service.app import create_app
from service.kit.arriving_files import DEMONSTRATION
from service.kit.bell import Bell
from service.kit.filling import Filling
from service.kit.guard import Failure
from service.kit.metrics import Metrics
from service.queue.records import Rank, WorkKind
from service.queue.store import PendingWork, WorkQueue
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from service.work.helper import KeepGoing
from service.work.kinds import KINDS, LEASE, Kind
from service.work.loop import Worker, work_next
from service.work.readers import Reader
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
LATER = NOW + timedelta(hours=1)


def shown(storage: Storage, seed: int = 1) -> str:
    """A session of the demonstration, stored long ago."""
    content = session_bytes(seed=seed, unit="DEMO", origin="simulated")
    return upload(storage, content, "demo.json", NOW - timedelta(days=9), who=DEMONSTRATION, is_dated_later=True).id


def own(storage: Storage, seed: int = 2, unit: str = "OWN") -> str:
    content = session_bytes(seed=seed, unit=unit, origin="simulated")
    return upload(storage, content, "own.json", NOW, is_dated_later=True).id


def in_order(storage: Storage) -> list[tuple[WorkKind, str]]:
    with storage.database.reading() as store:
        return PendingWork(store).first(KINDS, LATER, 100, max(Rank))


def rank(storage: Storage, kind: WorkKind, key: str) -> Rank | None:
    with storage.database.reading() as store:
        waiting = WorkQueue(store, kind).get(key)
    return None if waiting is None else waiting.rank


def test_what_was_uploaded_comes_before_groups_and_these_before_the_demonstration(storage: Storage) -> None:
    demo, id = shown(storage), own(storage)
    found = in_order(storage)
    assert set(found[:2]) == {(WorkKind.DIAGNOSIS, id), (WorkKind.OUTLOOK, "OWN")}
    at = found.index((WorkKind.DIAGNOSIS, demo))
    groups = [i for i, (kind, _) in enumerate(found) if kind in (WorkKind.GROUP, WorkKind.SUMMARY)]
    assert [i for i in groups if i < at] == list(range(2, at))
    assert found[-1] == (WorkKind.GROUP, "unit 1"), "the group of the demonstration's own unit"


def test_what_somebody_looks_at_comes_first_whatever_it_is(storage: Storage) -> None:
    demo, _ = shown(storage), own(storage)
    Reader(storage, lambda: NOW, Bell(), Metrics(), 2.0, workers=1).look_at(demo)
    assert in_order(storage)[0] == (WorkKind.DIAGNOSIS, demo)


def test_a_unit_of_the_demonstration_with_a_session_of_somebody_is_his(storage: Storage) -> None:
    demo, id = shown(storage), own(storage, unit="DEMO")
    ranks = [rank(storage, WorkKind.DIAGNOSIS, session) for session in (demo, id)]
    assert ranks == [Rank.DEMONSTRATION, Rank.UPLOADED]
    assert rank(storage, WorkKind.OUTLOOK, "DEMO") is Rank.UPLOADED


def test_while_the_demonstration_is_stored_only_what_somebody_uploaded_is_done(
    settings: Settings, storage: Storage
) -> None:
    shown(storage)
    id, did = own(storage), list[str]()
    filling = Filling(lambda _: None, 1)
    worker = Worker(settings, storage, lambda: LATER, Metrics(), Bell(), filling)

    def do(kind: Kind, key: str, _: datetime, __: KeepGoing) -> Failure | None:
        did.append(key)
        with storage.database.writing() as store:
            WorkQueue(store, kind.kind).drop(key)
        return None

    while work_next(worker, do, Event(), *KINDS.values()):
        pass
    assert set(did[:2]) == {id, "OWN"}
    assert {kind for kind, _ in in_order(storage)} == {WorkKind.DIAGNOSIS, WorkKind.OUTLOOK, WorkKind.GROUP}
    filling.run(Event())
    assert work_next(worker, do, Event(), *KINDS.values())


@pytest.mark.usefixtures("patient_readers")
@pytest.mark.parametrize("page", ["/sessions/{id}", "/sessions/{id}/outcome", "/sessions/{id}/diagnosis", "/units/OWN"])
def test_whoever_opens_a_page_is_waited_for(settings: Settings, storage: Storage, page: str) -> None:
    id = own(storage)
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.DIAGNOSIS).claim(id, NOW, NOW + LEASE)
    worked = settings.model_copy(update={"diagnosis_workers": 1})
    with stores(worked), http_client(create_app(worked, lambda: NOW)) as client:
        assert rank(storage, WorkKind.DIAGNOSIS, id) is Rank.UPLOADED
        client.get(page.format(id=id), headers={"Accept": "text/html"}).raise_for_status()
        assert rank(storage, WorkKind.DIAGNOSIS, id) is Rank.AWAITED
