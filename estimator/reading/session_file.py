"""A session file, part by part. Validation happens here, once; nothing after it looks again."""

from collections.abc import Mapping
from pathlib import Path

from estimator.message import say
from estimator.reading.bounds import WITHIN
from estimator.reading.fields import Fields
from estimator.reading.keys import FORMAT, TOP, check_keys
from estimator.reading.problems import Extent, Problems, Where, shown
from estimator.reading.schedule import check_schedule
from estimator.reading.sensors import KINDS, check_pulses, read_sensors
from estimator.reading.setting import read_moment, read_mounting, read_site, read_stand, read_time_since_power_on
from estimator.reading.source import display_name, load
from estimator.reading.table import read_table
from estimator.screening import Screen
from estimator.session import COUNTERS, IN_SERVICE, ORIGINS, PROGRAMMES, SIMULATED, STAGES, CalibrationSession


def read_session(
    source: str | Path | Mapping[str, object] | bytes,
    *,
    name: str | None = None,
    most: Extent | None = None,
    part: bool = False,
    rows_before: int | None = None,
    where: Where | None = None,
    screen: Screen | None = None,
) -> CalibrationSession:
    """Read and check one calibration session.

    Parameters
    ----------
    source : a path (.json, or .csv with its metadata), a dict with the content of a JSON file, or a file's bytes.
    name : what messages call the source; the path unless given.
    most : how much it may hold; `Extent()` unless given.
    part : whether these are some rows of a longer log, which need not support the programme by themselves.
    rows_before : rows of that log before these, as messages count; None of a log that is read whole.
    where : says where a field and row stand in the file that a dict was read from; messages name it.
    screen : what was found in the parts before; a part without it is taken as it stands.

    Returns
    -------
    CalibrationSession, in SI; every array has been checked.

    Raises
    ------
    FormatError : the source cannot be read, or fields of it are wrong; ``problems`` holds every one with its row.
    ScheduleError : every field is right, but the rows cannot support the programme.
    """
    problems = Problems(name or display_name(source), most, where, rows_before)
    return _assemble(Fields(load(source, problems), "", problems), part=part, screen=screen)


def _assemble(document: Fields, *, part: bool, screen: Screen | None) -> CalibrationSession:
    """All parts of the session; raises what any of them recorded."""
    problems = document.problems
    _check_format(document)
    check_keys(document, TOP)
    unit = document.required_text("unit", "give the unit's serial number")
    block = document.choice("block", KINDS)
    programme = document.choice("programme", PROGRAMMES, instead=IN_SERVICE)  # which asks for least
    started_at = read_moment(document, "started_at")
    on_for = read_time_since_power_on(document, started_at)
    sensors = read_sensors(document, block)
    kinds = {sensor.kind for sensor in sensors} or {block}
    site = read_site(document, programme, kinds)
    stand = read_stand(document, programme, kinds)
    mounting = read_mounting(document)
    check_pulses(document, sensors, programme)
    count_time = document.optional_number("count_time_s", WITHIN["count_time_s"])
    counter = document.choice("counter", COUNTERS) if document.has("counter") else None
    stage = document.choice("stage", STAGES) if document.has("stage") else None
    origin = document.choice("origin", ORIGINS) if document.has("origin") else None
    texts = {key: document.optional_text(key) for key in ("unit_type", "operator", "notes")}
    table = read_table(document, programme, sensors, part=part, screen=screen)
    if table is not None and not part:
        check_schedule(programme, table, kinds, raw=table.sample_rate is not None, problems=problems)
    problems.raise_if_any()
    assert table is not None, "a session without a table has problems"
    begun = 0.0 if table.time is None else float(table.time[0])
    return CalibrationSession(
        unit=unit,
        block=block,
        programme=programme,
        sensors=sensors,
        **vars(table),
        site=site,
        stand=stand,
        mounting=mounting,
        count_time=count_time,
        counter=counter,
        unit_type=texts["unit_type"] or None,
        started_at=started_at,
        switched_on=None if on_for is None else begun - on_for,
        operator=texts["operator"] or "",
        notes=texts["notes"] or "",
        stage=stage,
        origin=SIMULATED if origin == SIMULATED else None,
    )


def _check_format(document: Fields) -> None:
    declared = document.values.get("format")
    if not (isinstance(declared, str) and declared == FORMAT):
        stated = "missing" if declared is None else say("is {declared}", declared=shown(declared))
        document.add("format", '{stated}; must be "{format}"', stated=stated, format=FORMAT)
