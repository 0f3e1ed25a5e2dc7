"""Flow: what a session tells of its groups is worked out once, beside its diagnosis, and kept."""

from datetime import datetime

from estimator.errors import SessionError
from estimator.groups import statistics_of
from estimator.session import CALIBRATIONS
from service.ingest import read_upload
from service.records.work import WorkKind
from service.settings import VERSION
from service.storage import Storage
from service.storage.files import LOST


def keep_statistics(storage: Storage, session: str, now: datetime) -> None:
    """Makes the statistics of a session that calibrates a block, where they are still to be made, and asks for the
    answers of its groups, who try again where the program failed."""
    with storage.database.writing() as store:
        stored = store.sessions.get(session)
        if stored.programme not in CALIBRATIONS or not store.statistics.begin(session, VERSION):
            return
    try:
        add_statistics(storage, session, stored.sha256, stored.filename)
    finally:
        with storage.database.writing() as store:
            groups = store.groups.of_unit(stored.unit)
            store.work(WorkKind.GROUP).ask_each((one.place for one in groups), now)


def add_statistics(storage: Storage, session: str, sha256: str, filename: str) -> None:
    """The numerical part, with no transaction open. A lost file is tried again when somebody asks."""
    try:
        record = statistics_of(read_upload(storage.files.content(sha256), filename))
    except LOST:
        with storage.database.writing() as store:
            store.statistics.release(session)
    except SessionError as fault:
        with storage.database.writing() as store:
            store.statistics.fail(session, str(fault))
    else:
        with storage.database.writing() as store:
            store.statistics.keep(session, record)
