"""Step: a verdict and the findings about its session → the verdict's reservations.

The verdict in force is one of several: of the baseline, of the model with the named causes, and of the model with each
alternative that the readings leave standing. Where they agree, and no finding is large beside a tolerance, it is plain.
"""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from estimator.causes import find
from estimator.causes.sensor import ReadingOutlier
from estimator.diagnosis import Finding
from estimator.diagnosis.explanation.accepted import calibrate_extended
from estimator.diagnosis.explanation.temperature import LEAST_DIFFERENCE, OF_TEMPERATURE
from estimator.diagnosis.results import NoiseScale, Structure
from estimator.health.detection import LEVEL, warmed
from estimator.health.fits import Readings
from estimator.health.prognosis import Track
from estimator.health.temperature_law import NO_STEPS, Steps
from estimator.health.warmth import Warmth
from estimator.results import Calibration, Residuals, TurnsOutcome
from estimator.session import CALIBRATIONS, GYROSCOPE, CalibrationSession
from service.diagnosis.words.causes import UNKNOWN_CAUSE
from service.judging.cause_sizes import Size, Yardstick, size_of_cause, size_of_structure
from service.judging.covered import covered
from service.judging.judge import judge
from service.judging.temperature_words import at_about, elsewhere, worth_in
from service.judging.words import (
    ADD,
    CORRECT,
    FAILED,
    REPEAT,
    REPORT,
    RESTATE,
    TOO_FEW,
    advice_on,
    advice_on_structure,
    advice_on_turns,
    named,
    otherwise,
    size_in_words,
    turns_in_words,
    unexplained,
    within,
)
from service.kit.measures import COVERAGE
from service.outlook.rules.histories import TrackKey, histories
from service.outlook.store import ChangeRow, ReferenceRow
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.sessions.records import StoredSession
from service.sessions.words.noise import wrong_errors
from service.types.records import UnitType


@dataclass(frozen=True, eq=False)
class Covered:
    """Temperatures of a unit and of a session of it."""

    lowest: float
    highest: float
    reference: float
    """°C of the session that others are judged against, its mean."""
    now: float
    """Temperature of the session, °C."""
    changes: tuple[ChangeRow, ...] = ()
    """Changes in earlier sessions, where the session lies outside."""
    references: tuple[ReferenceRow, ...] = ()

    @property
    def outside(self) -> float:
        """°C by which the session lies outside; below zero where colder."""
        return self.now - float(np.clip(self.now, self.lowest, self.highest))

    @property
    def is_far(self) -> bool:
        """Whether it was measured at another temperature."""
        return abs(self.outside) > LEAST_DIFFERENCE


def covered_by(
    session: StoredSession, reference: Residuals, earlier: Iterable[StoredSession], steps: Steps = NO_STEPS
) -> Covered | None:
    """The temperatures that a reference, earlier sessions and the session's law cover; None where nothing says them."""
    known = covered(reference, ((s.temperature, s.verdict) for s in earlier), steps.values())
    if session.temperature is None or known is None:
        return None
    return Covered(known.lowest, known.highest, known.reference, session.temperature)


def worth_of(covered: Covered) -> tuple[Size, ...] | None:
    """The effect of the step in temperature on every parameter, by the earlier sessions; None where they do not tell.

    The law, a line or a parabola, is taken to go on beyond the temperatures that they span.
    """
    known = histories(covered.changes, covered.references)
    laws = [_law(track) for track in known.tracks]
    if not laws or any(law is None for law in laws):
        return None
    step = (covered.reference, covered.now)
    rows = zip(known.keys, known.tracks, laws, strict=True)
    return tuple(_size(key, track.tolerance, law, step) for key, track, law in rows if law is not None)


def _law(track: Track) -> Warmth | None:
    if track.temperature is None or track.dof is None:
        return None
    n, allowed = len(track.time), track.tolerance
    changes = Readings(track.time, track.change / allowed, track.sigma / allowed, np.ones((n, 1)), np.ones(1))
    return warmed(changes, 0.0, track.dof, track.temperature, LEVEL).warmth


def _size(key: TrackKey, tolerance: float, law: Warmth, step: tuple[float, float]) -> Size:
    worth, sigma = law.between(*step)
    value, u = float(np.linalg.norm(worth)) * tolerance, float(sigma.max()) * tolerance
    return Size((key.sensor,), key.kind, key.parameter, value, u, tolerance)


MOST_ALTERNATIVES = 3
"""Most alternatives of the strongest finding, the likeliest ones, under which a verdict is computed: each costs another
calibration.
"""


@dataclass(frozen=True, eq=False)
class Basis:
    """Basis of a session's verdict under any model."""

    reference: Calibration
    unit_type: UnitType
    coverage_factor: float
    steps: Steps = field(default_factory=dict)
    """Effects of the session's temperature."""

    def verdict_of(self, calibration: Calibration) -> Verdict:
        """The verdict by the same rule as for an upload."""
        return judge(calibration, self.reference, self.unit_type, self.coverage_factor, steps=self.steps).verdict


@dataclass(frozen=True)
class Otherwise:
    """The verdict under another model than the one in force."""

    causes: tuple[str, ...]
    """Identifiers of the causes in that model; empty for the baseline."""
    sensors: tuple[str, ...]
    """Sensors on which its first cause acts."""
    verdict: Verdict
    named: bool = False
    """Whether it is the model with the causes that the diagnosis names."""


def verdicts_under_alternatives(
    session: CalibrationSession, findings: tuple[Finding, ...], basis: Basis
) -> Iterator[Otherwise]:
    """The verdicts under each of the likeliest alternatives of the strongest finding, in its place among the other
    names.

    There are none where the record is wrong: the session is to be uploaded again; none for an alignment: it removes the
    effects of such causes; and none for a finding from several sessions together: this one cannot fit it.
    """
    findings = tuple(f for f in findings if f.over_sessions is None)
    if (
        session.programme not in CALIBRATIONS
        or not findings
        or any(is_of_record(finding.cause) for finding in findings)
    ):
        return
    first = findings[0]
    others = tuple((f.cause, _once(f.sensors)) for f in findings[1:] if acts_within(f.cause))
    for name in _of_the_session(first)[:MOST_ALTERNATIVES]:
        if name == UNKNOWN_CAUSE or acts_within(name):
            chosen = () if name == UNKNOWN_CAUSE else ((name, _sensors(name, first)),)
            causes = (*chosen, *others)
            verdict = basis.verdict_of(calibrate_extended(session, causes))
            yield Otherwise(tuple(cause for cause, _ in causes), chosen[0][1] if chosen else (), verdict)


def _of_the_session(first: Finding) -> tuple[str, ...]:
    """Alternatives that a model of the session can hold: it cannot show an effect of temperature between sessions."""
    known = find(first.cause)
    between = known is not None and known.between
    return tuple(name for name in first.alternatives if not (between and name in OF_TEMPERATURE))


def is_of_record(name: str) -> bool:
    """Whether a cause says that the file is wrong: then no model makes the session right. Of what only gyros have it is
    the latitude, which the file states."""
    known = find(name)
    return known is not None and (known.scope == "record" or (known.scope == "gyro" and known.between))


def acts_within(name: str) -> bool:
    """Whether a cause acts within the session, and is not in its model anyway: no change since earlier ones, which the
    tolerances judge."""
    known = find(name)
    return known is not None and not known.between and not known.always_modelled


def _sensors(name: str, first: Finding) -> tuple[str, ...]:
    """A cause of the stand or fixture acts on no sensor in particular."""
    known = find(name)
    return _once(first.sensors) if known is not None and known.is_of_sensor else ()


def _once(sensors: tuple[str, ...]) -> tuple[str, ...]:
    """A sensor that jumped twice is one sensor."""
    return tuple(dict.fromkeys(sensors))


WORTH_SAYING = 1 / 3
"""Part of a tolerance from which on an effect is a reservation: the most that may stay uncertain, too."""
Known = frozenset[tuple[str, str]]
"""Causes that are in the model in force, with the sensor or an empty name."""

UNCHECKED = (Reservation(Doubt.NOT_CHECKED, FAILED, REPORT),)
"""Reservations of a session that could not be diagnosed."""


@dataclass(frozen=True, eq=False)
class Doubted:
    """Findings about a session, beside its verdict."""

    verdict: Verdict | None
    """Verdict in force; None for a reference, or where nothing was judged."""
    findings: tuple[Finding, ...]
    structures: tuple[Structure, ...]
    noise: tuple[NoiseScale, ...]
    yardstick: Yardstick
    otherwise: tuple[Otherwise, ...]
    """Verdicts under the other models that are left standing."""
    known: Known = frozenset()
    temperatures: Covered | None = None
    """Temperatures besides those of its unit; None where nothing states them, or nothing was judged."""
    worth: tuple[Size, ...] | None = None
    """Effect of the step in temperature on every parameter; None where that is not known."""


def reservations_of(session: Doubted) -> tuple[Reservation, ...]:
    """The verdict's reservations, by how much they matter; empty where it has none."""
    found = (
        *_of_temperature(session.temperatures, session.worth),
        *_of_findings(session),
        *_of_models(session),
        *_of_structures(session),
        *_of_errors(session),
        *_of_readings(session),
        *_of_turns(session.yardstick.calibration),
    )
    return tuple(sorted(found, key=lambda r: (list(Doubt).index(r.kind), -(r.share or 0.0))))


def _of_findings(session: Doubted) -> Iterator[Reservation]:
    """The reservations of record errors always, and of large causes. A change since earlier sessions is judged by the
    tolerances; a cause that is in the model already, or was set aside before the fit, is accounted for.
    """
    out = {(ReadingOutlier.identifier, reading.sensor) for reading in session.yardstick.calibration.set_aside}
    for finding in session.findings:
        if all((finding.cause, sensor) in out for sensor in finding.sensors or ("",)):
            continue
        of_record = is_of_record(finding.cause)
        size = None if of_record or not acts_within(finding.cause) else size_of_cause(finding, session.yardstick)
        if of_record or (_is_large(size) and not _is_known(finding, session.known)):
            kind, text = Doubt.RECORD if of_record else Doubt.CAUSE, named(finding, _in_words(size))
            plain = Reservation(
                kind, text, advice_on(finding.cause, *finding.alternatives), finding.sensors, finding.cause
            )
            yield _sized(plain, size)


def reservations_at(temperatures: Covered | None) -> tuple[Reservation, ...]:
    """The reservations of a session in which no causes are looked for, such as a recording in service."""
    return tuple(_of_temperature(temperatures, worth_at(temperatures)))


def worth_at(temperatures: Covered | None, taken: Collection[tuple[str, str]] = ()) -> tuple[Size, ...] | None:
    """The effects of a step out of the temperatures that a unit covers, on every parameter but those that were
    corrected for it; None where there is no step, or where they are not known.
    """
    sizes = None if temperatures is None or not temperatures.is_far else worth_of(temperatures)
    return None if sizes is None else tuple(size for size in sizes if (size.sensors[0], size.parameter) not in taken)


def _of_temperature(seen: Covered | None, sizes: tuple[Size, ...] | None) -> Iterator[Reservation]:
    """The reservation of a session outside the temperatures that its unit covers, unless the effect is known to be
    small.
    """
    if seen is None or not seen.is_far or sizes == ():
        return
    worth = None if sizes is None else max(sizes, key=_at_most)
    if worth is not None and _at_most(worth) <= WORTH_SAYING:
        return
    known = "" if worth is None else worth_in(worth.parameter, worth.sensors[0], _in_words(worth))
    text = elsewhere(seen.outside, seen.now, (seen.lowest, seen.highest), known)
    sensors = () if worth is None else worth.sensors
    yield _sized(Reservation(Doubt.TEMPERATURE, text, at_about(seen.reference), sensors), worth)


def _at_most(size: Size) -> float:
    """The size as a share of the tolerance, with U."""
    return (size.value + COVERAGE * (size.sigma or 0.0)) / size.tolerance


def _is_large(size: Size | None) -> bool:
    return size is not None and size.share > WORTH_SAYING


def _is_known(finding: Finding, known: Known) -> bool:
    """Whether the model in force holds the cause, or one that is equally possible, wherever it acts."""
    possible = (finding.cause, *finding.alternatives)
    return all(any((name, place) in known for name in possible) for place in finding.sensors or ("",))


def _of_models(session: Doubted) -> Iterator[Reservation]:
    """Each other verdict once, the worst first."""
    named: set[Verdict] = {session.verdict} if session.verdict is not None else set(Verdict)
    for other in sorted(session.otherwise, key=lambda alternative: -alternative.verdict.severity):
        if other.verdict not in named:
            named.add(other.verdict)
            text = otherwise(other.verdict, other.causes, other.sensors, named=other.named)
            advice = advice_on(*other.causes) if other.named and other.causes else REPEAT
            yield Reservation(Doubt.OTHER_MODEL, text, advice, other.sensors, verdict=other.verdict)


def _of_structures(session: Doubted) -> Iterator[Reservation]:
    """The reservation of a pattern in the record, and else of the largest one."""
    record = [s for s in session.structures if s.of_record]
    if record:
        yield Reservation(Doubt.RECORD, unexplained(record, ""), CORRECT)
        return
    sized = ((s, size_of_structure(s, session.yardstick)) for s in session.structures)
    large = [(s, size) for s, size in sized if size is not None and _is_large(size)]
    if large:
        first, size = max(large, key=lambda pair: pair[1].share)
        text = unexplained((first,), _in_words(size))
        yield _sized(Reservation(Doubt.UNEXPLAINED, text, advice_on_structure(first), first.sensors), size)


def _of_errors(session: Doubted) -> Iterator[Reservation]:
    """Errors stated too large only make a verdict plainer, so they are named where one is in doubt."""
    in_doubt = session.verdict not in (None, Verdict.PASS, Verdict.FAIL)
    wrong = (scale for scale in session.noise if scale.factor > 1 or in_doubt)
    kinds = {sensor.kind for sensor in session.yardstick.calibration.sensors}
    for scale in wrong:
        [sentence] = wrong_errors((scale,), kinds)
        yield Reservation(Doubt.STATED_ERRORS, within(sentence), RESTATE, scale.sensors)


def _of_readings(session: Doubted) -> Iterable[Reservation]:
    """The reservation of a session without readings left over to look for causes in."""
    exact = session.yardstick.calibration.fit.is_exact and not session.findings
    return (Reservation(Doubt.NOT_CHECKED, TOO_FEW, ADD),) if exact else ()


def _of_turns(calibration: Calibration) -> Iterator[Reservation]:
    """The reservation of gyros that turns by hand gave no scale factors, or with a larger uncertainty."""
    turns = calibration.hand_turns
    if turns is None or (turns.outcome is TurnsOutcome.USED and turns.scatter == 1.0):
        return
    gyros = tuple(sensor.name for sensor in calibration.sensors if sensor.kind == GYROSCOPE)
    yield Reservation(Doubt.HAND_TURNS, turns_in_words(turns), advice_on_turns(turns), gyros)


def _in_words(size: Size | None) -> str:
    return "" if size is None else size_in_words(size.kind, size.parameter, (size.value, size.sigma), size.tolerance)


def _sized(plain: Reservation, size: Size | None) -> Reservation:
    """The reservation with the size that it rests on."""
    if size is None:
        return plain
    return replace(plain, parameter=size.parameter, size=size.value, uncertainty=size.sigma, share=size.share)
