"""Step: before a session is judged or stored: a unit's sessions are all measured, or all simulated.

Simulated sessions tell nothing of hardware: they must not move a measured unit's verdict, due date, flags or forecasts.
"""

import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime, timedelta

import numpy as np
from scipy.special import gammainc

from estimator.errors import FormatError, problem_at
from estimator.health.population import spread
from estimator.message import say
from estimator.results import SensorCalibration
from estimator.session import CALIBRATIONS, CalibrationSession
from service.ingest.checked import Checked
from service.judging.reference import KnownUnit
from service.kit.measures import day_of, zone_of
from service.sessions.doubt import Doubt, FileCorrection, Remedy
from service.sessions.history_store import History
from service.sessions.records import ParameterValue, StoredSession
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.store import Units

OTHERS_MEASURED = (
    "this session is simulated, but the sessions of unit {unit} were measured; they are not mixed: give the simulated "
    "unit its own serial number"
)
OTHERS_SIMULATED = (
    "this session was measured, but the sessions of unit {unit} are simulated; they are not mixed: withdraw the "
    "simulated ones, or give this unit its own serial number"
)


def require_one_origin(store: Store, session: CalibrationSession) -> bool:
    """FormatError where the session is simulated and its unit's others are measured, or the other way round.

    A unit whose simulated sessions were all withdrawn may be measured: somebody had tried out its serial number. True
    where it is measured from now on.
    """
    known = Units(store).is_simulated(session.unit)
    if known is None or known == session.is_simulated:
        return False
    if session.is_simulated:
        raise FormatError([problem_at("origin", OTHERS_MEASURED, unit=session.unit)])
    if Sessions(store).any_stands(session.unit):
        raise FormatError([problem_at("origin", OTHERS_SIMULATED, unit=session.unit)])
    return True


DIGITS = frozenset("0123456789")
LEAST_SPAN = 30
"""Numbers by which a series of few known units may go on: the units that one order brings."""
SHORTEST = 6
"""Characters of a serial number from which on one keystroke can be a slip: of a shorter one it is as often another
unit."""
SEVERAL = 2
"""Letters at one place, from which on they tell units apart as digits do."""
CYRILLIC = dict(
    zip(
        "\u0430\u0432\u0441\u0435\u043d\u0456\u0458\u043a\u043c\u043e\u0440\u0455\u0442\u0443\u0445",
        "abcehljkmopstyx",
        strict=True,
    )
)
"""Small letters that look like Latin ones, as small letters or as capitals."""
GREEK = dict(
    zip(
        "\u03b1\u03b2\u03b5\u03b7\u03b9\u03ba\u03bc\u03bd\u03bf\u03c1\u03c4\u03c5\u03c7\u03b6",
        "abehlkmnoptyxz",
        strict=True,
    )
)
LOOK_ALIKES = str.maketrans({**CYRILLIC, **GREEK, "0": "o", "1": "l", "i": "l", "|": "l"})
"""Characters that are read for one another, as far as keyboards in use have them (from Unicode TS 39)."""


def folded(serial: str) -> str:
    """A form equal for all serial numbers that are read for one another: without case, encoding, kind of dash or
    space.
    """
    plain = unicodedata.normalize("NFKC", serial).casefold().translate(LOOK_ALIKES)
    return "".join("-" if unicodedata.category(c) == "Pd" else c for c in plain if not c.isspace())


def is_one_keystroke(new: str, other: str) -> bool:
    """Whether one character was written for another, left out or added, or two beside one another exchanged; of serial
    numbers that are long enough to tell."""
    a, b, _ = _difference(new, other)
    if max(len(new), len(other)) < SHORTEST:
        return False
    return sorted((len(a), len(b))) in ([0, 1], [1, 1]) or (len(a) == 2 and a == b[::-1])


def is_slip(new: str, known: str, fleet: Collection[str]) -> bool:
    """Whether a new serial number that is one keystroke from a known one is rather a slip than the next of the fleet's
    series; ``fleet`` are the serial numbers of the type's known units."""
    a, b, place = _difference(new, known)
    if len(a) == len(b):
        return not DIGITS.issuperset(a + b) and not (len(a) == 1 and _tells_apart(new, place, fleet))
    return not DIGITS.issuperset(a + b) or _leaves_series(new, known, place, fleet)


def _difference(new: str, other: str) -> tuple[str, str, int]:
    """The parts of both between their common beginning and end, and their place."""
    start = next((i for i, (a, b) in enumerate(zip(new, other, strict=False)) if a != b), min(len(new), len(other)))
    rest = list(zip(new[start:][::-1], other[start:][::-1], strict=False))
    end = next((i for i, (a, b) in enumerate(rest) if a != b), len(rest))
    return new[start : len(new) - end], other[start : len(other) - end], start


def _tells_apart(new: str, place: int, fleet: Iterable[str]) -> bool:
    """Whether units of the fleet differ by a letter at a place."""
    frame = _frame(new, place)
    letters = {s[place] for s in fleet if len(s) == len(new) and _frame(s, place) == frame}
    return len(letters - DIGITS) >= SEVERAL


def _frame(serial: str, place: int) -> str:
    """The serial number around a place, whichever its digits."""
    return "".join("?" if i == place else "9" if c in DIGITS else c for i, c in enumerate(serial))


def _leaves_series(new: str, known: str, place: int, fleet: Iterable[str]) -> bool:
    """Whether a number with a digit more or less is none that the series would have."""
    head, number, tail = _around(new, place)
    known_number = known[len(head) : len(known) - len(tail)]
    if not number or not known_number or int(number) == int(known_number):
        return True
    heads = (s[len(head) : len(s) - len(tail)] for s in fleet if s.startswith(head) and s.endswith(tail))
    numbers = [int(run) for run in heads if run and DIGITS.issuperset(run)]
    span = max(max(numbers) - min(numbers), LEAST_SPAN)
    return not min(numbers) - span <= int(number) <= max(numbers) + span


def _around(serial: str, place: int) -> tuple[str, str, str]:
    """The parts before, in and behind the run of digits at a place."""
    start, end = place, place
    while start > 0 and serial[start - 1] in DIGITS:
        start -= 1
    while end < len(serial) and serial[end] in DIGITS:
        end += 1
    return serial[:start], serial[start:end], serial[end:]


FEWEST = 5
"""Other units of the type, from which on it is known how far units lie apart."""
APART = 5.0
"""Times the uncertainty that units must lie apart for a parameter to tell one from another."""
CHANCE = 1e-9
"""Largest chance that two units of the type lie so close: a unit of a fleet has some thirty neighbours in number, so
that among a hundred thousand units one is asked for nothing with a chance of 0.3 %.
"""
MOST = 60
"""Units of a type, those with the newest references, that its spread is taken from."""
Values = Mapping[tuple[str, str], ParameterValue]


def of_unit(
    known: KnownUnit, new: Checked, sensors: Sequence[SensorCalibration], but: Collection[str]
) -> Iterator[Doubt]:
    """A doubt for a session that is probably of another unit; ``but`` are itself and the one that it replaces."""
    copy = Sessions(known.store).of_readings(new.readings_digest, known.unit, but)
    if copy is not None:
        yield Doubt(
            say(
                "These readings are stored already as session {id} of {unit}, {started_at}",
                id=copy.id,
                unit=copy.unit,
                started_at=day_of(copy.started_at),
            ),
            say(
                "is this {unit}? The serial number is mistyped in one of both files, or this is a copy", unit=copy.unit
            ),
            FileCorrection(Remedy.UNIT, unit=copy.unit),
            stands_for=copy.id,
        )
        return
    is_new = not any(counted.id not in but for counted in known.records.counted)
    if is_new and len(but) == 1:  # one that replaces another was looked at by somebody
        near = _near(known, new, sensors)
        if near is not None:
            yield Doubt(
                say(
                    "{unit} is new, and {similar_unit} is known; {question}",
                    unit=new.session.unit,
                    similar_unit=near[0],
                    question=near[1],
                ),
                say("is this {similar_unit}? The serial number is probably mistyped", similar_unit=near[0]),
                FileCorrection(Remedy.UNIT, unit=near[0]),
            )


def _near(known: KnownUnit, new: Checked, sensors: Sequence[SensorCalibration]) -> tuple[str, str] | None:
    """The known unit that a new one probably is, and why."""
    serial = new.session.unit
    own_type = UnitTypes(known.store).of_unit(serial).name
    units = Units(known.store).accepted(simulated=new.session.is_simulated)
    alike = folded(serial)
    for other, _ in units:
        if other != serial and folded(other) == alike:
            return other, "the two serial numbers look alike"
    fleet = [other for other, kind in units if kind == own_type and other != serial]
    beside = [other for other in fleet if is_one_keystroke(serial, other)]
    slip = next((other for other in beside if is_slip(serial, other, fleet)), None)
    if slip is not None:
        return slip, "the two serial numbers differ by one keystroke"
    if beside and new.session.programme in CALIBRATIONS:
        return _of_same_calibration(known, own_type, beside, sensors)
    return None


def _of_same_calibration(
    known: KnownUnit, own_type: str, beside: Sequence[str], sensors: Sequence[SensorCalibration]
) -> tuple[str, str] | None:
    """The neighbour whose parameters these are."""
    others = History(known.store).references_by_unit(own_type, MOST)
    others |= History(known.store).references_by_unit(own_type, MOST, beside)
    if len(others) <= FEWEST:
        return None
    for other in beside:
        rest = [values for serial, values in others.items() if serial != other]
        if other in others and _is_chance_small(sensors, others[other], rest):
            return other, (
                "they differ in one digit and agree in every calibrated parameter, unlike any two units of the type"
            )
    return None


def _is_chance_small(sensors: Sequence[SensorCalibration], near: Values, rest: Sequence[Values]) -> bool:
    """Whether two units of the type lie so close to one another with a chance that is negligible: the difference of
    two units' parameters has twice the variance of one."""
    squares = []
    for sensor in sensors:
        for parameter in ("scale", "bias"):
            estimate, stored = getattr(sensor, parameter), near.get((sensor.name, parameter))
            values = [v for r in rest if (v := r.get((sensor.name, parameter))) is not None and v.value is not None]
            if estimate.value is None or stored is None or stored.value is None or len(values) < FEWEST:
                continue
            _, wide = spread(np.array([v.value for v in values]), np.array([v.u or 0.0 for v in values]))
            sure = float(np.hypot(estimate.sigma or 0.0, stored.u or 0.0))
            if wide > APART * sure:
                squares.append((estimate.value - stored.value) ** 2 / (2 * wide**2))
    return bool(squares) and float(gammainc(len(squares) / 2, sum(squares) / 2)) < CHANCE


FIRST_CLOCK = datetime(1980, 1, 7, tzinfo=UTC)
"""Clocks that lost their time start in 1970, or in 1980 with GPS; there was no session file then."""
MILLENNIUM, RUNNING = datetime(2000, 1, 1, tzinfo=UTC), timedelta(days=31)
"""Start of the clocks of loggers that lost their time, and the time that such a clock runs before somebody sets it."""
LONGEST_LIFE = timedelta(days=3653)
"""Longest time before a unit's first session: of older ones the records are missing, or the date is wrong."""
LOST = "the clock was wrong; write the date of the measurement into the file"


def of_date(known: KnownUnit, new: Checked, but: Collection[str]) -> Iterator[Doubt]:
    """A doubt for a date before the unit existed; ``but`` are sessions that say nothing of that."""
    at, day = new.measured_at, day_of(new.measured_at)
    if at < FIRST_CLOCK or MILLENNIUM <= at < MILLENNIUM + RUNNING:
        yield Doubt(say("It is dated {day}", day=day), LOST)
        return
    first = next((counted.at for counted in known.records.counted if counted.id not in but), None)
    if first is not None and first - at > LONGEST_LIFE:
        years = (first - at).days // 365
        yield Doubt(say("It is dated {day}, {years} years before the unit's first session", day=day, years=years), LOST)


def of_moment(known: KnownUnit, new: Checked, but: Collection[str]) -> Iterator[Doubt]:
    """A doubt for an accepted session of the same block, programme and moment, other than ``but``."""
    session = new.session
    if session.started_at is None:
        return
    occasion = (session.block, session.programme, new.measured_at)
    for counted in known.records.counted:
        if (counted.block, counted.programme, counted.at) != occasion or counted.id in but:
            continue
        rival = Sessions(known.store).get(counted.id)
        if not _are_apart(known, rival, new):
            yield Doubt(
                say(
                    "The session of {filename} was measured at the same moment, {measured_at}",
                    filename=rival.filename,
                    measured_at=_moment(new.measured_at),
                ),
                "this file corrects that one or is a copy of it, or one of both has a wrong time",
                stands_for=rival.id,
            )
            return


def _moment(at: datetime) -> str:
    """``1 May 2026, 09:00:00 UTC``."""
    return say("{day}, {time} {zone}", day=day_of(at), time=f"{at:%H:%M:%S}", zone=zone_of(at))


def _are_apart(known: KnownUnit, rival: StoredSession, new: Checked) -> bool:
    """Whether both can be, at one moment."""
    if {rival.stage, new.session.stage} == {"as-found", "as-left"}:
        return True
    measured = {sensor.name for sensor in known.calibration(rival.id).sensors}
    return measured.isdisjoint(sensor.name for sensor in new.session.sensors)
