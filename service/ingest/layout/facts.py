"""Facts of a session from its table's columns and values: programme, sample rate, and the kind, unit, scale and axis
of each sensor."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, TypeVar

import numpy as np

from estimator.errors import Problem
from estimator.json_object import Json
from estimator.message import say
from estimator.screening.clock import MOST_POSITIONS, SAMPLES
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.layout.evidence import (
    EPOCH,
    GRAVITIES,
    RATE_UNITS,
    TIME_UNITS,
    UNIT_TOLERANCE,
    Array,
    TurnFactors,
    clock_unit,
    follows_itself,
    gravity_at_rest,
    is_like_gravity,
    sample_rate,
    turns_of,
)
from service.ingest.layout.kinds import is_sensor
from service.ingest.layout.times import moment_of
from service.ingest.layout.triads import AXES, values_of
from service.ingest.layout.understand import SeenColumn, Understood
from service.ingest.layout.vocabulary import LETTERS, conversion, plain_label, unit_of

LABELLED = ("run", "beta_deg", "turn_angle_deg", "position")
"""Columns that say how the block stood."""
SI = {ACCELEROMETER: "m/s²", GYROSCOPE: "rad/s"}
QUANTITY = {ACCELEROMETER: "acceleration", GYROSCOPE: "rate"}
COUNT = "count"
SAME_RATE = 0.02
"""Largest relative difference between the rate of a clock and the one that the file states."""
DIGITS = 4
"""Significant digits of a nominal scale factor that is estimated: the calibration finds the others."""
ORIENTATIONS, STAND = "arbitrary-orientations", "two-axis-stand"
NO_STAND = {"id": ""}
"""A stand without any facts."""


def in_order(sensors: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of sensors by their axis or number."""
    return sorted((str(sensor.get("name")) for sensor in sensors), key=lambda name: (len(name), name))


class Rows:
    """The columns of a mapping with their values."""

    def __init__(self, columns: Sequence[Mapping[str, Any]], seen: Sequence[SeenColumn], rows: int) -> None:
        self.rows = rows
        pairs = [(column, one) for column, one in zip(columns, seen, strict=True) if column.get("as")]
        self.columns = {str(column["as"]): column for column, _ in pairs}
        self._seen = {str(column["as"]): one for column, one in pairs}

    def readings(self, names: Sequence[str]) -> Array | None:
        """(n, k) values of some columns; None where any has none."""
        return values_of({name: self._seen[name].values for name in names if name in self._seen}, names)

    def triad(self, sensors: Sequence[Mapping[str, Any]]) -> Array | None:
        """(n, 3) readings of three sensors along x, y, z; None of more or fewer, or where there are none."""
        return self.readings(in_order(sensors)) if len(sensors) == AXES else None

    @property
    def is_labelled(self) -> bool:
        """Whether rows are of a stand or a turntable, or say their position."""
        return any(name in self.columns for name in LABELLED)

    def asks_unit_of_time(self) -> bool:
        """Whether times are numbers without a unit."""
        return "time_s" in self.columns and self._seen["time_s"].numeric and not self.columns["time_s"].get("unit")

    def rate(self, unit: str = "") -> float | None:
        """Samples a second by the times; None of positions, and without a time or its unit."""
        if "time_s" not in self.columns or self.is_labelled or (self.asks_unit_of_time() and not unit):
            return None
        time = self._seen["time_s"].values
        if time is None or not len(time) or not np.isfinite(time).all():
            return None
        stated = unit or str(self.columns["time_s"].get("unit") or "s")
        times, over, _ = conversion(stated, "s") or (1.0, 1.0, 0.0)
        return sample_rate((time - time[0]) * times / over)

    def likely_unit_of_time(self) -> str:
        """The unit of times without one that makes their rate a usual one."""
        time = self._seen["time_s"].values
        return "" if time is None else clock_unit(time)[0]

    def is_log(self, sensors: Sequence[str]) -> bool:
        """Whether rows without a label are samples, by their number or their likeness."""
        if self.is_labelled or self.rows < SAMPLES:
            return False
        readings = self.readings(sensors)
        return self.rows > MOST_POSITIONS or (readings is not None and follows_itself(readings))


def facts_seen(guesses: Sequence[Understood], seen: Sequence[SeenColumn], rows: int) -> Json:
    """Facts of a session of which nothing is known but its table; sensors yet to be completed."""
    columns = [guess.column for guess in guesses]
    named = [guess for guess in guesses if guess.column["as"] and is_sensor(guess.column["as"])]
    kinds = [guess.kind for guess in named]
    block = GYROSCOPE if GYROSCOPE in kinds and ACCELEROMETER not in kinds else ACCELEROMETER
    table = Rows(columns, seen, rows)
    rate = table.rate()
    sensors = [
        {"name": guess.column["as"], "kind": guess.kind or block, "reading_unit": guess.column.get("unit", "")}
        for guess in named
    ]
    is_log = rate is not None or table.is_log([guess.column["as"] for guess in named])
    is_of_rests = any(name in table.columns for name in ("direction_x", "position")) and "run" not in table.columns
    programme = ORIENTATIONS if is_log or is_of_rests else STAND
    facts: Json = {"block": block, "programme": programme, "sensors": sensors}
    facts |= {"stand": NO_STAND} if programme == STAND else {}
    return facts if rate is None else {**facts, "sample_rate_hz": rate}


def with_unit_of_time(
    columns: Sequence[Json], seen: Sequence[SeenColumn], rows: int, rate: object = None
) -> list[Json]:
    """The columns with the likely unit of times without one, where the turns that gyros read confirm it; with the
    ``rate`` that the file states, Hz, the unit that gives it, or else without these times."""
    table = Rows(columns, seen, rows)
    if isinstance(rate, float) and table.asks_unit_of_time():
        units = (u for u in TIME_UNITS if abs((table.rate(u) or 0.0) - rate) <= SAME_RATE * rate)
        unit = next(units, "")
        known: Json = {"unit": unit} if unit else {"as": None}
        return [{**column, **known} if column["as"] == "time_s" else column for column in columns]
    unit = table.likely_unit_of_time() if table.asks_unit_of_time() else ""
    if not unit:
        return list(columns)
    names = {
        letter: [{"name": name} for name in table.columns if name[0] == letter and is_sensor(name)] for letter in "AG"
    }
    felt, turned = map(table.triad, names.values())
    turns, rate = None if felt is None or turned is None else turns_of(felt, turned), table.rate(unit)
    found = "" if turns is None or rate is None else turns.unit(rate)
    stated = str(table.columns[names["G"][0]["name"]].get("unit") or "") if found else ""
    if not found or (stated and plain_label(stated) not in (found, COUNT)):
        return list(columns)
    return [{**column, "unit": unit} if column["as"] == "time_s" else column for column in columns]


def started_at(columns: Sequence[Json], seen: Sequence[SeenColumn]) -> Json:
    """The start of a session by the first of its times, where these are dates or count from 1970."""
    for column, one in zip(columns, seen, strict=True):
        if column.get("as") != "time_s" or not one.cells:
            continue
        if not one.numeric:
            moment = moment_of(one.cells[0].strip())
            return {} if moment is None else {"started_at": moment.isoformat() + ("Z" if moment.tzinfo is None else "")}
        times, over, _ = conversion(str(column.get("unit") or "s"), "s") or (1.0, 1.0, 0.0)
        seconds = 0.0 if one.values is None else float(one.values[0]) * times / over
        if EPOCH[0] <= seconds < EPOCH[1]:
            return {"started_at": datetime.fromtimestamp(round(seconds), UTC).isoformat().replace("+00:00", "Z")}
    return {}


Entry = TypeVar("Entry", bound=Mapping[str, Any])


def _sensors_of(session: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The entries of its sensors; none where any is malformed."""
    sensors = session.get("sensors")
    entries = list(sensors) if isinstance(sensors, list | tuple) else []
    return entries if all(isinstance(entry, Mapping) for entry in entries) else []


def _by_kind(sensors: Sequence[Entry], session: Mapping[str, Any]) -> dict[str, list[Entry]]:
    return {kind: [s for s in sensors if (s.get("kind") or session.get("block")) == kind] for kind in LETTERS}


def completed(session: Json, table: Rows) -> Json:
    """The session with what units, gravity and turns say of sensors of which nothing else is stated."""
    if not _sensors_of(session):
        return session
    sensors = [dict(sensor) for sensor in _sensors_of(session)]
    by_kind = _by_kind(sensors, session)
    for of_kind in by_kind.values():
        for sensor in of_kind:
            unit = str(table.columns.get(str(sensor.get("name")), {}).get("unit") or "")
            sensor["reading_unit"] = sensor.get("reading_unit") or unit
    if session.get("programme") == ORIENTATIONS:
        if session.get("sample_rate_hz") is None and (rate := table.rate()) is not None:
            session = {**session, "sample_rate_hz": rate}
        _triads(session, by_kind, table)
    for kind, of_kind in by_kind.items():
        for sensor in of_kind:
            if not sensor.get("nominal_scale") and (scale := _scale(str(sensor["reading_unit"]), kind)):
                sensor["nominal_scale"] = scale
    return {**session, "sensors": sensors}


def _scale(unit: str, kind: str) -> float | None:
    """Readings per m/s² or rad/s of a unit of the kind's own quantity."""
    measure = unit_of(unit)
    if measure is None or measure.quantity != QUANTITY[kind]:
        return None
    return float(measure.over / measure.times)


def _triads(session: Json, by_kind: Mapping[str, list[Json]], table: Rows) -> None:
    """Axes along x, y and z of three sensors of a kind, with the units and signs that their values show; a unit of some
    is that of all."""
    felt = table.triad(by_kind[ACCELEROMETER])
    turned = table.triad(by_kind[GYROSCOPE])
    turns = None if felt is None or turned is None else turns_of(felt, turned)
    for kind, of_kind in by_kind.items():
        signs = np.sign(turns.factors) if turns is not None and kind == GYROSCOPE else np.ones(AXES)
        units = {unit for sensor in of_kind if (unit := sensor["reading_unit"])}
        for sensor in of_kind:
            sensor["reading_unit"] = units.copy().pop() if len(units) == 1 else sensor["reading_unit"]
            letter, order = "XYZ".find(str(sensor["name"])[-1:]), in_order(of_kind).index(str(sensor.get("name")))
            axis = letter if letter >= 0 else order if len(of_kind) == AXES else None
            if axis is not None and not sensor.get("nominal_axis"):
                sign = float(signs[order]) if len(of_kind) == AXES else 1.0
                sensor["nominal_axis"] = [sign * (k == axis) + 0.0 for k in range(AXES)]
    _measured(by_kind[ACCELEROMETER], None if felt is None else gravity_at_rest(felt))
    rate = session.get("sample_rate_hz")
    if turns is not None and turned is not None and isinstance(rate, int | float):
        _turned(by_kind[GYROSCOPE], turns, float(rate), is_whole=bool(np.all(turned == np.round(turned))))


def _measured(sensors: Sequence[Json], at_rest: float | None) -> None:
    """The scale factor of accelerometers in counts by their readings of gravity."""
    for sensor in sensors:
        if at_rest and not sensor.get("nominal_scale") and plain_label(str(sensor["reading_unit"])) == COUNT:
            sensor["nominal_scale"] = float(f"{at_rest / GRAVITIES['m/s²']:.{DIGITS}g}")


def _turned(sensors: Sequence[Json], turns: TurnFactors, rate: float, *, is_whole: bool) -> None:
    """The unit of gyros by the turns, or the scale factor of those in counts."""
    for sensor in sensors:
        if not sensor["reading_unit"]:
            sensor["reading_unit"] = turns.unit(rate) or (COUNT if is_whole else "")
        if plain_label(str(sensor["reading_unit"])) == COUNT and not sensor.get("nominal_scale"):
            usual = float(np.median(np.abs(turns.factors))) * rate
            sensor["nominal_scale"] = float(f"{1 / usual:.{DIGITS}g}")


def questions(session: Mapping[str, Any], table: Rows) -> tuple[Problem, ...]:
    """Contradictions of kind, unit and sign, which are asked although the session could be read without an answer."""
    sensors, problems = _sensors_of(session), []
    for number, sensor in enumerate(sensors, start=1):
        kind, unit = str(sensor.get("kind") or session.get("block")), str(sensor.get("reading_unit") or "")
        quantity = getattr(unit_of(unit), "quantity", "")
        if kind in QUANTITY and quantity in QUANTITY.values() and quantity != QUANTITY[kind]:
            text = say("is {unit}, which no {kind} reads in; correct the kind or the unit", unit=unit, kind=kind)
            problems.append(Problem(f"sensors[{number}].reading_unit", text))
    problems += _contradicted(session, sensors, table)
    if session.get("programme") != ORIENTATIONS or not table.is_log([str(s.get("name")) for s in sensors]):
        return tuple(problems)
    if table.asks_unit_of_time():
        unit = table.likely_unit_of_time()
        text = say("is without a unit; choose it")
        if unit and (rate := table.rate(unit)) is not None:
            text = say("is without a unit; choose it: with {unit} the rate is {rate} Hz", unit=unit, rate=f"{rate:g}")
        problems.append(Problem("time_s", text))
    elif session.get("sample_rate_hz") is None:
        text = say("missing; the rows follow one another as the samples of a raw log do")
        problems.append(Problem("sample_rate_hz", text))
    return tuple(problems)


def _contradicted(session: Mapping[str, Any], sensors: Sequence[Mapping[str, Any]], table: Rows) -> Iterator[Problem]:
    """Units of gyros that the turns between rests contradict, many times over."""
    by_kind, rate = _by_kind(sensors, session), session.get("sample_rate_hz")
    felt, turned = map(table.triad, by_kind.values())
    turns = None if felt is None or turned is None else turns_of(felt, turned)
    found = turns.unit(float(rate)) if turns is not None and isinstance(rate, int | float) else ""
    for number, sensor in enumerate(sensors, start=1):
        name, unit = str(sensor.get("name")), str(sensor.get("reading_unit") or "")
        stated = plain_label(str(table.columns.get(name, {}).get("unit") or unit))
        if found and sensor in by_kind[GYROSCOPE] and stated != found and stated in RATE_UNITS:
            text = say("is {unit}, but by the turns between rests it is {found}", unit=stated, found=found)
            yield Problem(f"sensors[{number}].reading_unit", text)


def is_contradicted(session: Mapping[str, Any], table: Rows) -> bool:
    """Whether gravity at rest or the turns of a log contradict units, scale factors or signs of three accelerometers
    and gyros along x, y and z that an earlier file had."""
    by_kind, rate = _by_kind(_sensors_of(session), session), session.get("sample_rate_hz")
    felt, turned = map(table.triad, by_kind.values())
    usual = {kind: _along_axes(of_kind, table) for kind, of_kind in by_kind.items()}
    length, of_gravity = None if felt is None else gravity_at_rest(felt), usual[ACCELEROMETER]
    if session.get("programme") != ORIENTATIONS or felt is None or length is None:
        return False
    if of_gravity is None or (of_gravity <= 0).any():
        return False
    if not is_like_gravity(length, float(np.median(of_gravity)) * GRAVITIES["m/s²"]):
        return True
    turns, of_turns = None if turned is None else turns_of(felt, turned), usual[GYROSCOPE]
    if turns is None or of_turns is None or not isinstance(rate, int | float):
        return False
    return bool(np.any(np.abs(turns.factors * rate * of_turns - 1) > UNIT_TOLERANCE))


def _along_axes(sensors: Sequence[Mapping[str, Any]], table: Rows) -> Array | None:
    """(3,) readings per m/s² or rad/s along x, y and z as the columns have them; None of other axes or no scale."""
    named = {str(sensor.get("name")): sensor for sensor in sensors}
    factors = []
    for place, name in enumerate(in_order(sensors)):
        axis, scale = named[name].get("nominal_axis"), named[name].get("nominal_scale")
        read_in = str(table.columns.get(name, {}).get("unit") or "")
        converted = conversion(read_in, str(named[name].get("reading_unit") or read_in))
        if not isinstance(axis, list | tuple) or [abs(part) for part in axis] != [k == place for k in range(AXES)]:
            return None
        if not isinstance(scale, int | float) or converted is None:
            return None
        factors.append(scale * axis[place] * converted[1] / converted[0])
    return np.array(factors)


def following_the_rate(session: Mapping[str, Any], table: Rows) -> Iterator[str]:
    """Fields that follow once the unit of time or the rate of a log is stated: the rate, and by the turns units and
    scale factors of gyros."""
    sensors = _sensors_of(session)
    by_kind = _by_kind(sensors, session)
    felt, turned = map(table.triad, by_kind.values())
    if table.asks_unit_of_time():
        yield "sample_rate_hz"
    if session.get("sample_rate_hz") is not None or felt is None or turned is None or turns_of(felt, turned) is None:
        return
    for number, sensor in enumerate(sensors, start=1):
        if sensor in by_kind[GYROSCOPE]:
            yield from (f"sensors[{number}].{key}" for key in ("reading_unit", "nominal_scale"))
