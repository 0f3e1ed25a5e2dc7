"""The interface of a cause: one physical effect that the baseline simulation lacks, and its trace in the readings.

A cause names itself, states its equation, what the session must provide, whom it acts on and what to do about it,
and yields its *shapes*: signature columns at the input, one for every place and nonlinear parameter it could have.
The simulation, the diagnosis, the extended fit, the detection limits and the documentation read it from here.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby
from typing import ClassVar

import numpy as np

from estimator.forward import input_of, projected, slope
from estimator.message import say
from estimator.parameters import SensorParameters
from estimator.session import Array, CalibrationSession

Grid = list[tuple[float, ...]]
"""Values of the nonlinear parameters, in the order of `Cause.nonlinear_units`: one tuple a shape."""

NEEDS = frozenset(
    {
        "time",
        "temperature",
        "vibration",
        "stand",
        "stand or directions",
        "both runs",
        "gravity",
        "nominal or history",
        "history",
    }
)
"""Everything that a cause may need of a session."""


LIVELIEST = 2.0
"""Times the usual row's variance that the liveliest row's must be for the vibration to vary at all: the variance of a
hundred samples scatters by a seventh."""


def varies(variance: Array) -> bool:
    """Whether variances (R, m), of any unit, of some column exceed mere scatter about one value."""
    return bool(np.any(variance.max(axis=0) > LIVELIEST * np.median(variance, axis=0)))


@dataclass(frozen=True, eq=False)
class Setting:
    """Everything that a cause may look at: applied vectors, sensors and recorded quantities. R rows, m sensors."""

    kinds: tuple[str, ...]
    parameters: SensorParameters
    """(m,) parameters at which the signatures are taken."""
    n: Array
    """(R, m, 3) applied vectors, block axes, m/s² (rad/s)."""
    norm: Array
    """(m,) length of the applied vector, m/s² (rad/s)."""
    beta: Array | None
    """(R,) rad; None without a stand."""
    flipped: Array | None
    """(R,) bool; None without a stand."""
    d_alpha: Array | None
    """(R, m, 3) change of n, m/s² (rad/s) per rad of elevation; None without a stand."""
    d_beta: Array | None
    """(R, m, 3) change of n, m/s² (rad/s) per rad of β; None without a stand."""
    time: Array | None
    """(R,) s."""
    temperature: Array | None
    """(R,) °C."""
    force: Array | None
    """(R, 3) specific force that gyros feel, block axes, m/s²; None where unknown."""
    latitude: float
    """rad."""
    turn: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) rotation vector, rad: how the block sits turned since the history; what turns it is linear about this."""
    flip_turn: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) rotation vector, rad: how the block sits turned in the flipped run, as n has it already."""
    framed: bool = True
    """Whether the applied vectors are known apart from the sensors, so that a common turn of all axes shows."""
    vibration: Array | None = None
    """(R, m) variance of the input within a row, (m/s²)² or (rad/s)²; None where unknown."""
    switched_on: float | None = None
    """s, by the clock of ``time``: when the unit was switched on; None where unknown."""

    @property
    def rows(self) -> int:
        return self.n.shape[0]

    @cached_property
    def a(self) -> Array:
        """(R, m) component along each input axis, m/s² (rad/s)."""
        return projected(self.parameters.axis, self.n)

    @cached_property
    def input(self) -> Array:
        """(R, m) inputs that the sensors integrate, a + b + c·a², m/s² (rad/s)."""
        return input_of(self.parameters, self.n)

    @property
    def first_of_run(self) -> Array:
        """(R,) bool, dimensionless: rows that no row of the same run precedes."""
        first = np.zeros(self.rows, dtype=bool)
        first[0] = True
        if self.flipped is not None:
            first[1:] = self.flipped[1:] != self.flipped[:-1]
        return first

    @cached_property
    def across(self) -> Array:
        """(R, m, 2) p·n and o·n, the components across each input axis, m/s² (rad/s)."""
        return (self.n.swapaxes(0, 1) @ self.parameters.axis_tangents).swapaxes(0, 1)

    def through(self, change: Array) -> Array:
        """Input change (R, m, q) of changes of the applied vector (R, m, 3, q), m/s² (rad/s) per unit amplitude."""
        along = (self.parameters.axis[:, :, None] * change).sum(axis=-2)
        return slope(self.parameters, self.n)[..., None] * along

    def has(self, need: str) -> bool:
        """Whether the session provides what a cause needs; ValueError where ``need`` is none of `NEEDS`."""
        match need:
            case "time":
                return self.time is not None
            case "temperature":
                return self.temperature is not None and float(np.ptp(self.temperature)) > 0
            case "vibration":
                return self.vibration is not None and varies(self.vibration)
            case "stand":
                return self.beta is not None
            case "stand or directions":
                return self.framed
            case "both runs":
                return self.flipped is not None and 0 < int(self.flipped.sum()) < self.rows
            case "gravity":
                return self.force is not None
            case "history" | "nominal or history":
                return True  # not of the session: judged where the history is
            case _:
                parts = {"unknown": repr(need), "known": ", ".join(sorted(NEEDS))}
                raise ValueError(say("no session can provide {unknown}: causes may need {known}", **parts))


@dataclass(frozen=True, eq=False)
class Shape:
    """One signature: what a unit amplitude adds at the input."""

    sensors: tuple[int, ...]
    """The sensors it is blamed on; empty for a cause of stand, fixture or record."""
    columns: Array
    """(R, m, q) input change, m/s² (rad/s) per unit of each amplitude."""
    nonlinear: tuple[float, ...] = ()
    """Values of the nonlinear parameters, in the order of `Cause.nonlinear_units`."""

    def first(self, q: int) -> "Shape":
        """The shape with its first q columns alone."""
        return replace(self, columns=self.columns[..., :q])


class Cause(ABC):
    """One cause of the catalogue: all that any room knows of it is an attribute here."""

    identifier: ClassVar[str]
    scope: ClassVar[str]
    """``sensor``, ``environment``, ``stand``, ``fixture``, ``record`` or ``gyro``."""
    equation: ClassVar[str]
    units: ClassVar[tuple[str, ...]]
    """SI unit of every amplitude, for an accelerometer; with m/s² read as rad/s for a gyro."""
    sentence: ClassVar[str]
    """Description of the fault, for a maintenance engineer; ``{sensors}`` is filled in."""
    advice: ClassVar[str]
    needs: ClassVar[frozenset[str]] = frozenset()
    """The needs, out of `NEEDS`; time, temperature and vibration are looked at only where they are needed."""
    nonlinear_units: ClassVar[tuple[str, ...]] = ()
    kind: ClassVar[str | None] = None
    """Kind of sensor it acts on; None for both."""
    between: ClassVar[bool] = False
    """Whether it shows in what changed since the history (or from nominal), not in the session's residuals."""
    passing: ClassVar[bool] = False
    """Whether it belongs to a single session, so that no model can hold it."""
    lasts: ClassVar[bool] = False
    """Whether it is a property of the sensor, which a repeated session shows again."""
    moves_parameters: ClassVar[bool] = False
    """Whether it truly changes the sensor's parameters, so that it stays in the calibration."""
    turns_flipped_run: ClassVar[bool] = False
    """Whether its amplitude is the rotation vector of the block in the flipped run, taken out as the rotation it is."""
    turns_block: ClassVar[bool] = False
    """Whether its amplitude is the rotation vector of the whole block, taken out as the rotation that it is."""
    grows_an_angle: ClassVar[bool] = False
    """Whether an amplitude in rad/s is an angle that grows with time, not a rate that is measured."""
    shared_sentence: ClassVar[str] = ""
    """The sentence where several sensors have it at once, as one event; empty where such events are not looked for."""
    shared_advice: ClassVar[str] = ""
    clips: ClassVar[bool] = False
    """Whether it cuts readings off at a limit, beyond which they tell nothing."""
    since_power_on: ClassVar[bool] = False
    """Whether its time counts from switching on, where the session says when that was."""
    lacking: ClassVar[str] = "a sensor it acts on"
    """The missing thing in a session that has all that the cause needs, and yet no shape of it."""
    always_modelled: ClassVar[bool] = False
    """Whether the model of its programme always includes it, so that nothing is left to accept."""
    shape_words: ClassVar[str] = ""
    """Name of its nonlinear parameter, for people: ``time constant``, ``from`` (a row)."""
    contains: ClassVar[frozenset[str]] = frozenset()
    """Causes that it is where some of its amplitudes are zero: beside one that is named it says nothing else."""
    amplitude_words: ClassVar[tuple[str, ...]] = ()
    """Name of each of several amplitudes, for people; empty where they are mere coefficients."""

    @property
    def name(self) -> str:
        """The identifier in words, for people: ``bias temperature``."""
        return self.identifier.replace("-", " ")

    @property
    def is_of_sensor(self) -> bool:
        """Whether it is a present property of one sensor, and not merely a change since earlier sessions."""
        return self.scope in ("sensor", "environment", "gyro") and not self.between

    @property
    def can_be_modelled(self) -> bool:
        """Whether it can be part of a model: it acts within every session, in the same way each time."""
        return False

    def available(self, setting: Setting) -> bool:
        """Whether the session provides what the cause needs within itself (history is judged elsewhere)."""
        return all(setting.has(need) for need in self.needs)


class Signature(Cause):
    """A cause whose effect is a linear combination of known columns."""

    bounded: ClassVar[bool] = False
    """Whether its amplitude must be one."""

    @property
    def can_be_modelled(self) -> bool:
        return not self.between and not self.passing

    @abstractmethod
    def shapes(self, setting: Setting) -> Iterator[Shape]:
        """Every signature the cause could leave in this session."""

    def columns(self, setting: Setting, shape: Shape) -> Array:
        """(R, m, q) effect of a shape in another session, m/s² (rad/s) per unit amplitude."""
        known = (s for s in self.shapes(setting) if (s.sensors, s.nonlinear) == (shape.sensors, shape.nonlinear))
        return next(known).columns

    def neighbours(self, setting: Setting, shape: Shape) -> Iterator[Shape]:
        """Shapes beside one of the grid, to find the best nonlinear parameters between its points."""
        yield from ()

    def left(self, setting: Setting, nonlinear: tuple[float, ...]) -> float:
        """Share of the amplitude that is there at the first row, dimensionless, in a shape."""
        return 1.0

    def reported(self, setting: Setting, shape: Shape, amplitude: Array, sigma: Array) -> tuple[Array, Array]:
        """Amplitude (q,) and sigma (q,) in SI as `units` names them, from those of the signature's columns."""
        return amplitude, sigma


class RecordCorrection(Cause):
    """A record error that can be undone: the corrected session is tried instead of a signature."""

    scope = "record"
    units = ()
    between = True
    of_rows: ClassVar[bool] = False
    """Whether it concerns rows, not sensors."""

    @abstractmethod
    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        """Every way to undo it: the sensors (or, for rows, the rows) concerned and the corrected session."""


class SensorCause(Signature):
    """A cause that acts on one sensor: `term` gives its columns, placed on every sensor in turn."""

    scope = "sensor"
    alike: ClassVar[bool] = False
    """Whether its term is the same on every sensor: a course of time, temperature or β alone."""

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        """Values of the nonlinear parameters to try; one empty tuple for a linear cause."""
        yield ()

    def grid_of(self, setting: Setting, i: int) -> Iterator[tuple[float, ...]]:
        """The grid for sensor i, where it is not the same for all."""
        yield from self.grid(setting)

    @abstractmethod
    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, q) effect of a unit amplitude inside the bracket of sensor i, m/s² (rad/s)."""

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, q) terms of sensor i at S points of the grid, m/s² (rad/s)."""
        terms = [self.term(setting, i, nonlinear) for nonlinear in grid]
        return terms[0][None] if len(terms) == 1 else np.stack(terms)

    def each(self, setting: Setting, grids: Iterable[tuple[int, Grid]]) -> Iterator[tuple[int, Grid, Array]]:
        """Sensors with their grids, and the terms (S, R, q) of each, m/s² (rad/s); alike ones are worked out once."""
        grid, terms = None, np.empty(0)
        for i, nonlinear in grids:
            if not self.alike or nonlinear != grid:
                grid, terms = nonlinear, self.terms(setting, i, nonlinear)
            yield i, nonlinear, terms

    def terms_of(self, setting: Setting, shapes: Sequence[Shape]) -> Iterator[tuple[int, Array]]:
        """Sensors one after another, each with the terms (S, R, q) of its shapes, m/s² (rad/s) per unit amplitude."""
        by_sensor = groupby(shapes, key=lambda shape: shape.sensors[0])
        grids = ((i, [s.nonlinear for s in members]) for i, members in by_sensor)
        yield from ((i, terms) for i, _, terms in self.each(setting, grids))

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        grids = ((i, list(self.grid_of(setting, i))) for i, k in enumerate(setting.kinds) if self.kind in (None, k))
        for i, grid, terms in self.each(setting, ((i, grid) for i, grid in grids if grid)):
            placed = on_sensor(setting, i, terms)
            yield from (Shape((i,), columns, nonlinear) for columns, nonlinear in zip(placed, grid, strict=True))

    def placed(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, m, q) the term on sensor i, m/s² (rad/s) per unit amplitude."""
        return on_sensor(setting, i, self.terms(setting, i, [nonlinear]))[0]

    def columns(self, setting: Setting, shape: Shape) -> Array:
        """(R, m, q) m/s² (rad/s) per unit amplitude."""
        return self.placed(setting, shape.sensors[0], shape.nonlinear)


class GridCause(SensorCause):
    """A cause of one sensor that is tried at many points: `terms` gives all of them at once."""

    @abstractmethod
    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, q) effects of a unit amplitude at S points of the grid inside sensor i's bracket, m/s² (rad/s)."""

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, q) term of sensor i at one point of the grid, m/s² (rad/s)."""
        return np.asarray(self.terms(setting, i, [nonlinear])[0])


class CommonCause(Signature):
    """A cause that acts on the applied vector, hence on all sensors: `change` gives how the vector moves."""

    @abstractmethod
    def change(self, setting: Setting) -> Array:
        """(R, m, 3, q) change of the applied vector, m/s² (rad/s) per unit amplitude."""

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        yield Shape((), setting.through(self.change(setting)))

    def columns(self, setting: Setting, shape: Shape) -> Array:
        """(R, m, q) m/s² (rad/s) per unit amplitude."""
        return setting.through(self.change(setting))


class Entry(CommonCause):
    """A number of the record that may be typed in wrong, one amplitude: it can be corrected by the amount found."""

    @abstractmethod
    def corrected_by(self, session: CalibrationSession, amount: float) -> CalibrationSession:
        """The session with ``amount`` (in the unit of the amplitude) added to the entry."""


def on_sensor(setting: Setting, i: int, terms: Array) -> Array:
    """(S, R, m, q) terms (S, R, q) of sensor i among all sensors, in the terms' own unit, such as m/s²."""
    columns = np.zeros((*terms.shape[:2], len(setting.kinds), terms.shape[2]))
    columns[:, :, i, :] = terms
    return columns


def column(*terms: Array) -> Array:
    """Stack terms (R,) as columns (R, q), in the terms' own unit, such as m/s²."""
    return terms[0][..., None] if len(terms) == 1 else np.stack(terms, axis=-1)
