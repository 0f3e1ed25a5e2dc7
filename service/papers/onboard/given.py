"""Input of every parameter file, and the comments common to all of them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from estimator.allan import BlockNoise
from estimator.moments import as_stated
from estimator.nominal_vector import NominalVector, nominal_vector
from estimator.session import ACCELEROMETER, GYROSCOPE, Array
from service.errors import ConflictError
from service.fleet.use import Use
from service.judging.records import Usable
from service.judging.usable_reading import usable_unit
from service.judging.words import verdict_in_words
from service.papers.correction import corrected
from service.sessions.calibrations_store import SessionNoises
from service.sessions.states import RecordState
from service.sessions.words.conditions import condition_of
from service.settings import VERSION
from service.storage import Storage

STANDARD_GRAVITY = 9.80665
"""m/s², at which the remaining error of an accelerometer is stated."""
FRAME = (
    "It corrects the vector that the driver makes of the readings by their nominal scale and axes.",
    "The driver's sensor axes must be the block's.",
)
DIGITS = 9
FORCE = "Where you need its parameters all the same, force it: `force=true`, `--force`."
REFUSED = "{unit} must not be used: {why} {force}"
NOT_COUNTED = "This session is {state}: its parameters are not handed on. {force}"


@dataclass(frozen=True)
class ExportInput:
    """The correction of one session."""

    unit: str
    session: str
    measured_at: datetime
    state: RecordState
    verdict: str
    """Verdict with its reservations, in the words of every page."""
    use: Usable
    """Permitted use of the unit now."""
    simulated: bool
    software: str
    vectors: dict[str, NominalVector]
    """Nominal vectors by kind of sensor."""
    noise: BlockNoise | None = None
    """Noise at rest; None where the session holds no rests."""
    temperature: float | None = None
    """°C that the parameters hold at, of a session with curves over temperature."""

    @property
    def accelerometers(self) -> NominalVector | None:
        """Vector of the accelerometers; None where the session calibrates none."""
        return self.vectors.get(ACCELEROMETER)

    @property
    def gyros(self) -> NominalVector | None:
        """Vector of the gyros; None where the session calibrates none."""
        return self.vectors.get(GYROSCOPE)


def noisiest(given: ExportInput, kind: str, term: str) -> float | None:
    """The largest size of a term of noise, SI; None where the session does not decide it of every sensor of a kind."""
    sensors = () if given.noise is None else given.noise.sensors
    sizes = [sensor.term(term).value for sensor in sensors if sensor.kind == kind]
    decided = [size for size in sizes if size is not None]
    return max(decided) if decided and len(decided) == len(sizes) else None


def heading(given: ExportInput, system: str) -> Iterator[str]:
    """The first comments of a file."""
    yield f"{system} parameters of unit {given.unit}, by {given.software}"
    yield f"session {given.session}, measured {as_stated(given.measured_at)}: {given.verdict}"
    yield from _uses(given)
    if given.simulated:
        yield "SIMULATED: this unit does not exist"
    if given.temperature is not None:
        yield f"parameters at {given.temperature:g} degrees Celsius; imu-correction/1 has them over temperature"
    yield from FRAME


def _uses(given: ExportInput) -> Iterator[str]:
    """The warnings that must be read before the numbers are used."""
    if given.state is not RecordState.ACCEPTED:
        yield f"THIS SESSION IS {given.state.value.upper()}"
    if given.use.answer is not Use.YES:
        said = given.use.use
        yield f"{given.use.as_of:%Y-%m-%d}: {said if given.use.usable else said.upper()}"
        yield from (*given.use.reasons, *given.use.reservations)


def check(given: ExportInput) -> None:
    """ConflictError where the unit must not be used, or the session does not count."""
    if given.state is not RecordState.ACCEPTED:
        raise ConflictError(NOT_COUNTED, state=given.state.value, force=FORCE)
    if not given.use.usable:
        raise ConflictError(REFUSED, unit=given.unit, why=given.use.why, force=FORCE)


def commented(lines: Iterable[str]) -> list[str]:
    """The lines as comments, valid in all four systems."""
    return [f"# {' '.join(line.split())}" for line in lines]


def unmixed(vector: NominalVector) -> tuple[Array, Array]:
    """Offset (3,), m/s² (rad/s), and scale (3,) of a correction that keeps the axes apart, (fₙ − offset)·scale."""
    return vector.offset, 1.0 / np.diag(vector.matrix)


def misalignment(vector: NominalVector) -> float:
    """Largest share, in rad, of one axis in another that such a correction leaves."""
    _, scale = unmixed(vector)
    left = scale[:, None] * vector.matrix - np.eye(3)
    return float(np.abs(left).max())


def number(value: float) -> str:
    """A plain decimal."""
    return f"{value:.{DIGITS}g}"


LEAST = 0.5
"""Share of its nominal scale that an axis must feel along itself."""
MOST_ASKEW = 0.1
"""rad: 1 m/s² at 1 g; a mounting is off by some hundredths."""


@dataclass(frozen=True)
class Names:
    """A system's names of the parameters, with a blank for the axis."""

    offset: str
    scale: str
    gyro_offset: str


def parameters(given: ExportInput, names: Names) -> Iterator[tuple[str, float]]:
    """Name and value, m/s², none and rad/s, of ``(raw − offset)·scale`` and of gyros ``raw − offset``.

    ConflictError where the axes lie so far from the nominal ones that no scale an axis puts them right."""
    for kind, vector in given.vectors.items():
        if not np.all(np.diag(vector.matrix) > LEAST) or misalignment(vector) > MOST_ASKEW:
            raise ConflictError(
                f"The {kind}s' axes lie too far from their nominal ones: an offset and a scale an axis cannot correct "
                "them. Look for exchanged or reversed channels, or hand on for Kalibr or ROS 2."
            )
    if given.accelerometers is not None:
        offset, scale = unmixed(given.accelerometers)
        yield from _named(names.offset, offset)
        yield from _named(names.scale, scale)
    if given.gyros is not None:
        yield from _named(names.gyro_offset, given.gyros.offset)


def _named(name: str, values: Array) -> Iterator[tuple[str, float]]:
    for axis, value in zip("XYZ", values, strict=True):
        yield name.format(axis), float(value)


def left_of(given: ExportInput) -> Iterator[str]:
    """One sentence a kind of sensor."""
    if given.accelerometers is not None:
        angle = misalignment(given.accelerometers)
        force = angle * STANDARD_GRAVITY
        bent = given.accelerometers.curvature * STANDARD_GRAVITY**2
        yield (
            f"Left in specific force: axes up to {1e3 * angle:.3g} mrad askew, {force:.2g} m/s² at 1 g; "
            f"quadratic terms, up to {bent:.2g} m/s² at 1 g."
        )
    if given.gyros is not None:
        angle, (_, scale) = misalignment(given.gyros), unmixed(given.gyros)
        yield (
            f"Left in angular rate: scale factors, up to {1e6 * float(np.abs(scale - 1).max()):.3g} ppm, "
            f"and axes up to {1e3 * angle:.3g} mrad askew: gyros have an offset only."
        )


def given_of(storage: Storage, id: str, now: datetime) -> ExportInput:
    """The input for a session; NotFoundError where its programme gives no correction, ConflictError where a sensor has
    none: the vector that a driver makes holds it too.
    """
    source = corrected(storage, id)
    if source.found.left_out:
        why = "; ".join(f"{name}: {reason}" for name, reason in source.found.left_out)
        raise ConflictError(f"The driver's vector holds sensors that have no correction. {why}.")
    with storage.database.reading() as store:
        noise, use = SessionNoises(store).get(id), usable_unit(store, source.stored.unit, now)
    curves = source.calibration.thermal
    return ExportInput(
        unit=source.stored.unit,
        session=source.stored.id,
        measured_at=source.stored.started_at,
        state=source.stored.state,
        verdict=verdict_in_words(
            condition_of(source.stored.verdict, is_reference=source.stored.is_reference), source.stored.reservations
        ),
        use=use,
        simulated=source.stored.simulated,
        software=f"imu-health {VERSION}",
        vectors={block.kind: nominal_vector(source.session, block) for block in source.found.blocks},
        noise=noise,
        temperature=None if curves is None else curves.reference_temperature,
    )
