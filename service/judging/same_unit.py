"""Step: is a session of the unit that its file says? Readings that are stored already under another serial number are a
copy; a new serial number that is nearly a known one is probably that one, mistyped; and so is one of a numbered series
whose calibration is that of a neighbour, far closer than two units of the type are.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from scipy.special import gammainc

from estimator.health.population import spread
from estimator.message import say
from estimator.results import SensorCalibration
from estimator.session import CALIBRATIONS
from service.ingest.checked import Checked
from service.judging.known_unit import KnownUnit
from service.judging.serials import folded, is_one_keystroke, is_slip
from service.kit.names import day_of
from service.sessions.doubt import Correction, Doubt, Remedy
from service.sessions.history_store import History
from service.sessions.records import ParameterValue
from service.sessions.store import Sessions
from service.types.store import UnitTypes
from service.units.store import Units

FEWEST = 5
"""Other units of the type, from which on it is known how far units lie apart."""
APART = 5.0
"""Times the uncertainty that units must lie apart for a parameter to tell one from another."""
CHANCE = 1e-9
"""That two units of the type lie so close by chance: a unit of a fleet has some thirty neighbours in number, so that
among a hundred thousand units one is asked for nothing with a chance of 0.3 %."""
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
            Correction(Remedy.UNIT, unit=copy.unit),
            stands_for=copy.id,
        )
        return
    is_new = not any(one.id not in but for one in known.records.counted)
    if is_new and len(but) == 1:  # one that replaces another was looked at by somebody
        near = _near(known, new, sensors)
        if near is not None:
            yield Doubt(
                say("{unit} is new, and {near} is known; {near2}", unit=new.session.unit, near=near[0], near2=near[1]),
                say("is this {near}? The serial number is probably mistyped", near=near[0]),
                Correction(Remedy.UNIT, unit=near[0]),
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
        return slip, "the two serial numbers are one keystroke apart"
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
            return other, "one digit apart, and every calibrated parameter agrees, as no two units of the type do"
    return None


def _is_chance_small(sensors: Sequence[SensorCalibration], near: Values, rest: Sequence[Values]) -> bool:
    """Whether two units of the type lie so close to one another with a chance that is negligible: the difference of
    two units' parameters has twice the variance of one."""
    squares = []
    for sensor in sensors:
        for parameter in ("scale", "bias"):
            own, stored = getattr(sensor, parameter), near.get((sensor.name, parameter))
            values = [v for one in rest if (v := one.get((sensor.name, parameter))) is not None and v.value is not None]
            if own.value is None or stored is None or stored.value is None or len(values) < FEWEST:
                continue
            _, wide = spread(np.array([v.value for v in values]), np.array([v.u or 0.0 for v in values]))
            sure = float(np.hypot(own.sigma or 0.0, stored.u or 0.0))
            if wide > APART * sure:
                squares.append((own.value - stored.value) ** 2 / (2 * wide**2))
    return bool(squares) and float(gammainc(len(squares) / 2, sum(squares) / 2)) < CHANCE
