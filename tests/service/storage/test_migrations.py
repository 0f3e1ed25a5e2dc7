"""Migrations make the schema that the code expects, and go down and up again on a database with data."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import inspect, select, text
from sqlalchemy.exc import DatabaseError

from service.diagnosis.tables import DiagnosisRow
from service.errors import AwayError
from service.flags.records import Delivery
from service.flags.webhooks_store import Webhooks
from service.fleet.store import Fleet
from service.jobs.records import Job, JobKind, NewJob
from service.jobs.store import Failures, Jobs
from service.models.records import Scope
from service.models.store import Models, Recomputations
from service.opening import open_database
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.diagnose import diagnose
from service.records.register import Entering, enter, move_unit
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.columns import PARTS
from service.storage.engine import open_engine
from service.storage.schema import downgrade, head_revision, stored_revision, upgrade
from service.storage.tables import Base
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry
from service.units.store import Units
from service.uploads.receive import upload
from tests.databases import Databases
from tests.service.diagnosed import TEMPERATURE, drawn, files_of
from tests.service.made_sessions import FAILED, session_bytes
from tests.service.work.test_given_up import accepted

REGISTERED = datetime(2026, 11, 21, tzinfo=UTC)


def test_the_migrated_schema_is_the_one_of_the_tables(store_url: str) -> None:
    engine = open_engine(store_url)
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []
    engine.dispose()


def test_upgrading_twice_is_upgrading_once(databases: Databases) -> None:
    url = databases.empty()
    upgrade(url)
    upgrade(url)
    engine = open_engine(url)
    with engine.connect() as connection:
        assert stored_revision(connection) == head_revision()
    engine.dispose()


def test_an_empty_database_is_not_ready_and_says_what_to_do(databases: Databases) -> None:
    database = open_database(databases.empty())
    with pytest.raises(AwayError, match="imu-health db upgrade"):
        database.require_ready()
    database.close()


def test_the_audit_refuses_to_be_changed(store_url: str) -> None:
    engine = open_engine(store_url)
    with engine.begin() as connection:
        connection.execute(
            text("INSERT INTO audit (at, who, action, subject, details) VALUES ('2026-01-01', 'a', 'b', 'c', '{}')")
        )
    for statement in ("UPDATE audit SET who = 'x'", "DELETE FROM audit"):
        with pytest.raises(DatabaseError, match="append-only"), engine.begin() as connection:
            connection.execute(text(statement))
    engine.dispose()


@pytest.mark.slow
def test_decisions_outlive_the_split_into_common_and_own_parts(store_url: str, storage: Storage) -> None:
    now = datetime(2026, 11, 21, tzinfo=UTC)
    upload(storage, session_bytes(), "a.json", now)
    id = upload(storage, session_bytes(seed=2, month=5), "b.json", now).id
    with storage.database.reading() as store:
        before, motions = Sessions(store).decisions(id), Sessions(store).motions(id)
    assert {(m.quantity, m.state) for m in motions} == {("axes", "separated"), ("scales", "separated")}
    storage.database.close()
    downgrade(store_url, "0002")
    upgrade(store_url)
    with storage.database.reading() as store:
        after, gone = Sessions(store).decisions(id), Sessions(store).motions(id)
    assert [(d.verdict, d.deviation) for d in after] == [(d.verdict, d.deviation) for d in before]
    assert all(d.change is not None for d in before)
    assert all(d.change is None for d in after)
    assert gone == ()


def test_down_to_nothing_and_up_again_with_data(store_url: str, storage: Storage) -> None:
    now = datetime(2026, 11, 21, tzinfo=UTC)
    upload(storage, session_bytes(), "a.json", now)
    storage.database.close()
    downgrade(store_url, "base")
    engine = open_engine(store_url)
    assert inspect(engine).get_table_names() == ["alembic_version"]
    engine.dispose()
    upgrade(store_url)
    storage.database.require_ready()
    assert upload(storage, session_bytes(), "a.json", now).created


def test_what_waits_is_carried_over_with_why_it_failed(store_url: str, storage: Storage) -> None:
    now = datetime(2026, 11, 21, tzinfo=UTC)
    id = upload(storage, session_bytes(), "a.json", now, is_dated_later=True).id
    with storage.database.writing() as store:
        WorkQueue(store, WorkKind.OUTLOOK).give_up("BA-017", "no numbers")
        WorkQueue(store, WorkKind.DERIVATION).add_failed("BA-017", "no reference", now)
        WorkQueue(store, WorkKind.DIAGNOSIS).put_off(id, now)
    with storage.database.reading() as store:
        places = WorkQueue(store, WorkKind.GROUP).waiting(now, 10)
        before = (WorkQueue(store, WorkKind.DIAGNOSIS).get(id), WorkQueue(store, WorkKind.OUTLOOK).get("BA-017"))
        listed = Failures(store).listed(now, 10)
    storage.database.close()
    downgrade(store_url, "0030")
    upgrade(store_url)
    with storage.database.reading() as store:
        assert before == (
            WorkQueue(store, WorkKind.DIAGNOSIS).get(id),
            WorkQueue(store, WorkKind.OUTLOOK).get("BA-017"),
        )
        assert set(WorkQueue(store, WorkKind.GROUP).waiting(now, 10)) == set(places)
        assert WorkQueue(store, WorkKind.OUTLOOK).waiting(now, 10) == ()
        assert Failures(store).listed(now, 10) == listed
    assert len(places) == 3
    assert len(listed) == 2


@pytest.mark.parametrize("question", ["SELECT reason FROM sessions", "SELECT text FROM notices"])
def test_an_earlier_schema_has_every_sentence_in_english(store_url: str, storage: Storage, question: str) -> None:
    for content in FAILED:
        upload(storage, content, "a.json", datetime(2026, 11, 21, tzinfo=UTC))
    storage.database.close()
    engine = open_engine(store_url)
    with engine.connect() as connection:
        kept = connection.scalars(text(question)).all()
    assert any(PARTS in sentence for sentence in kept)
    downgrade(store_url, "0032")
    with engine.connect() as connection:
        assert connection.scalars(text(question)).all() == [sentence.partition(PARTS)[0] for sentence in kept]
    with engine.begin() as connection, pytest.raises(DatabaseError, match="append-only"):
        connection.execute(text("UPDATE notices SET text = 'another'"))
    engine.dispose()


def test_jobs_messages_and_recomputations_wait_across_a_change_of_the_schema(store_url: str, storage: Storage) -> None:
    now = datetime(2026, 11, 21, tzinfo=UTC)
    with storage.database.writing() as store:
        Webhooks(store).add("http://127.0.0.1:9/hook", "sixteen or more letters", "K. Ito", now)
    session, *_ = [upload(storage, content, "a.json", now).id for content in FAILED]
    with storage.database.writing() as store:
        revision = Models(store).add(replace(accepted(), session=session)).id
        Recomputations(store).ask(revision, Scope.UNIT, "BA-017", now)
        for _ in range(2):
            Jobs(store).add(NewJob(JobKind.RECALIBRATION, "K. Ito"), 1, now)
        WorkQueue(store, WorkKind.JOB).record_failure("1", "no file")
        WorkQueue(store, WorkKind.JOB).put_off("1", now + timedelta(minutes=10))
        Jobs(store).cancel(2, "K. Ito", now)
    before = _work(storage, now)
    assert [len(waiting) for waiting in before[0]] == [1, 1, 2]
    storage.database.close()
    downgrade(store_url, "0031")
    upgrade(store_url)
    assert _work(storage, now) == before


def _work(storage: Storage, now: datetime) -> tuple[list[tuple[str, ...]], list[Job], tuple[Delivery, ...]]:
    """Work that waits in the queue after a quarter of an hour, with its records."""
    kinds, later = (WorkKind.RECOMPUTATION, WorkKind.JOB, WorkKind.MESSAGE), now + timedelta(minutes=15)
    with storage.database.reading() as store:
        waiting = [WorkQueue(store, kind).waiting(later, 10) for kind in kinds]
        return waiting, [Jobs(store).get(id) for id in (1, 2)], Webhooks(store).deliveries(1, 10)


def test_before_the_register_registered_units_go_and_retired_ones_are_in_use(store_url: str, storage: Storage) -> None:
    upload(storage, session_bytes(), "a.json", REGISTERED)
    enter(storage, (NewEntry("BA-900", "named only"),), Entering("K. Ito", REGISTERED))
    move_unit(storage, "BA-017", Move(step=CustodyStep.RETIRED), "K. Ito", REGISTERED)
    storage.database.close()
    downgrade(store_url, "0035")
    upgrade(store_url)
    again = Storage(open_database(store_url), storage.files)
    with again.database.writing() as store:
        assert UnitTypes(store).find("named only") is None
        Fleet(store).refresh(Units(store).key("BA-017"))
    with again.database.reading() as store:
        assert Units(store).every() == ("BA-017",)
        assert Fleet(store).condition().units == 1
    again.database.close()


def test_an_earlier_diagnosis_is_given_the_causes_that_explain_its_flags(store_url: str, storage: Storage) -> None:
    content = files_of(drawn(TEMPERATURE))[-1]
    now = datetime(2026, 11, 21, tzinfo=UTC)
    diagnose(storage, upload(storage, content, "a.json", now).id, now)
    storage.database.close()
    engine = open_engine(store_url)

    def evidence() -> Any:
        with engine.connect() as connection:
            return connection.scalars(select(DiagnosisRow.tells)).one()

    since = evidence()
    assert any(len(concern) > len(("matter", "place", "severity", "summary")) for concern in since["concerns"])
    downgrade(store_url, "0043")
    assert {len(concern) for concern in evidence()["concerns"]} == {4}
    upgrade(store_url)
    assert evidence() == since
    engine.dispose()
