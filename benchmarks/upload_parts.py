"""Processor time of an upload, part by part: of one session with 6 sensors, 24 positions and two runs.

Each part is the least of many times in one process: what other programs cost is not in it. What the database's driver
takes is counted within the whole upload, by SQLite; the rest is records and statements in Python, files and commits.

    python -m benchmarks.upload_parts
"""

import json
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from datetime import UTC, datetime, timedelta
from itertools import count
from pathlib import Path

from sqlalchemy import Engine, event

from service.ingest.checked import check
from service.ingest.digest import content_digest
from service.judging.calibrate import CalibrationBasis, calibrate
from service.judging.judge import judge
from service.models.records import Model
from service.opening import open_storage
from service.records.keep import made
from service.settings import Settings
from service.storage import Storage
from service.storage.schema import upgrade
from service.types.store import UnitTypes
from service.uploads.receive import upload
from tests.service.made_sessions import session_bytes

TIMES, UNITS = 60, 12
START = datetime(2020, 1, 1, tzinfo=UTC)
NOW = datetime(2026, 1, 1, tzinfo=UTC)
BASELINE = CalibrationBasis(Model(0, (), ()), None)
numbers = count()


def content() -> bytes:
    """A session of one of some units later than the ones before."""
    at = next(numbers)
    own = {"unit": f"P5-{at % UNITS}", "started_at": (START + timedelta(minutes=at)).isoformat()}
    return json.dumps(json.loads(session_bytes()) | own).encode()


def least(work: Callable[[], object]) -> float:
    """Milliseconds of the processor."""

    def once() -> float:
        began = time.process_time()
        work()
        return time.process_time() - began

    return 1e3 * min(once() for _ in range(TIMES))


class Asked:
    """Statements, and the time that the database's driver takes for them."""

    def __init__(self) -> None:
        self.statements, self.seconds, self._began = 0, 0.0, 0.0
        event.listen(Engine, "before_cursor_execute", self._begin)
        event.listen(Engine, "after_cursor_execute", self._end)

    def _begin(self, *_: object) -> None:
        self.statements, self._began = self.statements + 1, time.process_time()

    def _end(self, *_: object) -> None:
        self.seconds += time.process_time() - self._began


def parts(storage: Storage) -> Iterator[tuple[str, float]]:
    """Name and milliseconds of each part."""
    files = [content() for _ in range(TIMES + UNITS)]
    for file in files[:UNITS]:
        upload(storage, file, "a.json", NOW)
    file = files[0]
    checked = check(file, "a.json", NOW)
    found = calibrate(checked, BASELINE).calibration
    with storage.database.reading() as store:
        unit_type = UnitTypes(store).of_unit(checked.session.unit)
    waiting, asked = iter(files[UNITS:]), Asked()
    yield "the whole upload", least(lambda: upload(storage, next(waiting), "a.json", NOW))
    yield f"of it: the database's driver, {asked.statements / TIMES:.0f} statements", 1e3 * asked.seconds / TIMES
    yield "of it: parsing and checking the file", least(lambda: check(file, "a.json", NOW))
    yield "of it: the digest of its content", least(lambda: content_digest(checked.session))
    yield "of it: the calibration", least(lambda: calibrate(checked, BASELINE))
    yield "of it: the calibration's document and rows", least(lambda: made(found))
    yield "of it: the verdict of every parameter", least(lambda: judge(found, found, unit_type, 2.0))


def main() -> None:
    """Prints the table."""
    print("| part | processor, ms |\n| --- | --- |")
    with tempfile.TemporaryDirectory(prefix="imu-parts-") as folder:
        settings = Settings(data_folder=Path(folder), database_url=f"sqlite:///{folder}/parts.sqlite")
        upgrade(settings.database)
        storage = open_storage(settings)
        with closing(storage.database):
            for what, milliseconds in parts(storage):
                print(f"| {what} | {milliseconds:.2g} |", flush=True)


if __name__ == "__main__":
    main()
