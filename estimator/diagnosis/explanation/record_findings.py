"""Findings about the record, corrected before the search: clipped channels, record errors, wrong entries."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from estimator.applied_vector import ONE_PLACE, STANDARD_GRAVITY, common_factors
from estimator.calibration.gross_slips import UNKNOWN, sentences
from estimator.causes.catalogue import UNEXPLAINED
from estimator.causes.environment import BiasJump
from estimator.causes.record import GravityEntry, SensorDrift
from estimator.causes.sensor import ReadingOutlier, Saturation
from estimator.diagnosis.explanation.naming import listed, merged, named_cause
from estimator.diagnosis.explanation.rivals import CREDIBLE, SHOWN
from estimator.diagnosis.explanation.temperature import shared
from estimator.diagnosis.posterior.priors import SIZES, units
from estimator.diagnosis.record.clipping import Clip
from estimator.diagnosis.record.common_scale import CommonScale
from estimator.diagnosis.record.implausible import ImplausibleAxes
from estimator.diagnosis.record.nominal import WrongEntry
from estimator.diagnosis.record.record_error import RecordError
from estimator.diagnosis.record.turned import LEAST
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.results import Finding, Rival, Separation, Structure
from estimator.forward import measured
from estimator.message import capitalised, joined, say
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, CalibrationSession, SetAside

OUTLIER = ReadingOutlier()


def gross_findings(readings: Sequence[SetAside], session: CalibrationSession) -> tuple[Finding, ...]:
    """Readings of a session that were set aside, as one finding; they took no part in anything else."""
    known = [r for r in readings if np.isfinite(r.size)]
    if not known:
        return ()
    sensors = dict.fromkeys(r.sensor for r in known)
    possible = [tuple(alike([r for r in known if r.sensor == sensor], session)) for sensor in sensors]
    of_all = tuple(name for name in possible[0] if all(name in others for others in possible))
    found = merged([(OUTLIER, gross_finding(r, session, of_all)) for r in known])
    advice = joined(" ", sentences(known))
    if all(r.last_row > r.row for r in known):
        stood = say("{sensors} stood still for several rows.", sensors=listed(found[0].sensors))
        return (replace(found[0], sentence=capitalised(stood), advice=advice),)
    return tuple(replace(f, advice=advice) for f in found)


def gross_finding(reading: SetAside, session: CalibrationSession, others: tuple[str, ...]) -> Finding:
    """Describes one reading that was set aside, which ``others`` explain as well, each as likely."""
    kinds = {sensor.name: sensor.kind for sensor in session.sensors}
    names = (OUTLIER.identifier, *others)
    return replace(
        named_cause(OUTLIER, (reading.sensor,), 0.0, reading.strength),
        amplitude=(reading.size,),
        sigma=(reading.sigma,),
        units=("m/s²" if kinds[reading.sensor] == ACCELEROMETER else "rad/s",),
        nonlinear_each=({"row": float(reading.row)},),
        alternatives=others,
        ranking=tuple(Rival(name, (reading.sensor,), 1 / len(names), reading.strength) for name in names),
    )


def alike(readings: Sequence[SetAside], session: CalibrationSession) -> Iterator[str]:
    """The causes that show in the readings of one sensor that were set aside exactly as outliers do; none where their
    slips are known.

    A converter's limit holds readings that are short of what was expected and still the sensor's outermost. A zero that
    jumps, by no more than any may, before the last readings or after the first ones shows in these alone. Two outliers
    of one sensor are two misfortunes, for which there may be one cause that nobody knows.
    """
    if any(r.slip != UNKNOWN or r.suspects or r.last_row > r.row for r in readings):
        return
    rows, R = [r.row for r in readings], len(session.readings)
    (i,) = (k for k, sensor in enumerate(session.sensors) if sensor.name == readings[0].sensor)
    others = np.delete(session.readings[:, i], np.array(rows) - 1)
    outward = all(others.max() <= r.reading < r.expected for r in readings)
    if outward or all(others.min() >= r.reading > r.expected for r in readings):
        yield Saturation.identifier
    largest = SIZES[-1] * units((session.sensors[i].kind,), np.array([STANDARD_GRAVITY]))[0]
    ends = (list(range(1, len(rows) + 1)), list(range(R - len(rows) + 1, R + 1)))
    if rows in ends and all(abs(r.size) < largest for r in readings):
        yield BiasJump.identifier
    if len(readings) > 1:
        yield UNEXPLAINED


SCALED = (
    "All scale factors{of_kind} changed together by {change} % since the earlier sessions, more than gravity, latitude "
    "or a clock can do."
)
ONE_PLACE_ADVICE = (
    "The sessions state one place, where gravity is the same: if it was measured elsewhere, correct the record."
)
SCALED_ADVICE = (
    "Check the supply voltage, the converter's reference, the range setting and the temperature; repeat the session."
)


def clip_findings(
    clips: Sequence[Clip], session: CalibrationSession, baseline: Baseline, calibration: Calibration
) -> tuple[Finding, ...]:
    """Clipped sensors of a session as it came, as one finding: every limit at the input, with the noise of a reading
    and the uncertainty of the scale factor that it is counted by.

    ``baseline`` and ``calibration``: of the corrected session.
    """
    inputs = measured(session)[0] / baseline.parameters.scale
    limits = [abs(float((c.side * inputs[list(c.rows), c.sensor]).max())) for c in clips]
    scales = [calibration.sensors[c.sensor].scale for c in clips]
    known = [abs(k.sigma / k.value) if k.sigma and k.value else 0.0 for k in scales]
    clips_found = [
        (c.cause, clip_finding(c, limit, limit * relative, baseline))
        for c, limit, relative in zip(clips, limits, known, strict=True)
    ]
    return tuple(merged(clips_found))


def clip_finding(clip: Clip, limit: float, by_scale: float, baseline: Baseline) -> Finding:
    """One sensor clipped on one side at a limit known to ``by_scale`` by its scale, both m/s² or rad/s at the input.

    A single reading short of the input is clipped if it is the extreme of its R rows on this side; one that does not
    belong to the rest is so with a chance of 1 in R: that is their odds.
    """
    rows = len(baseline.session.readings)
    share = 1.0 if len(clip.rows) > 1 else rows / (rows + 1)
    sensor = baseline.session.sensors[clip.sensor]
    unit = "m/s²" if sensor.kind == ACCELEROMETER else "rad/s"
    return replace(
        named_cause(clip.cause, (sensor.name,), clip.p_value, clip.strength),
        amplitude=(limit,),
        sigma=(float(np.hypot(np.sqrt(np.median(baseline.variance[:, clip.sensor])), by_scale)),),
        units=(unit,),
        nonlinear_each=({unit: limit, "side": clip.side},),
        alternatives=() if share > CREDIBLE else (ReadingOutlier.identifier,),
        ranking=tuple(
            Rival(name, (sensor.name,), part, clip.strength)
            for name, part in ((clip.cause.identifier, share), (ReadingOutlier.identifier, 1 - share))
            if part > 0
        ),
    )


def record_error_finding(error: RecordError, session: CalibrationSession) -> Finding:
    """A record error, with the other ways to put the record right that do as well."""
    cause, places = error.undone.cause, error.undone.places
    reached, others = 0.0, list[str]()
    for attempt, share in error.posterior():
        name = attempt.cause.identifier
        if reached < CREDIBLE and name != cause.identifier and name not in others:
            others.append(name)
        reached += share
    strength = float(np.sqrt(2 * error.undone.log_evidence))
    shown = {f"row {k}": float(p + 1) for k, p in enumerate(places, 1)} if cause.of_rows else {}
    sensors = concerned(places, session, of_rows=cause.of_rows)
    return replace(
        named_cause(cause, sensors, float(np.exp(-error.undone.log_evidence)), strength),
        nonlinear_each=(shown,),
        alternatives=tuple(others),
        ranking=record_ranking(error, session, strength)[:SHOWN],
    )


def record_ranking(error: RecordError, session: CalibrationSession, strength: float) -> tuple[Rival, ...]:
    """The possible errors of the record, most likely first: without rows, so that one line covers all of them."""
    shares: dict[tuple[str, tuple[str, ...]], float] = {}
    for attempt, share in error.posterior():
        place = attempt.cause.identifier, concerned(attempt.places, session, of_rows=attempt.cause.of_rows)
        shares[place] = shares.get(place, 0.0) + share
    ranked = sorted(shares.items(), key=lambda item: -item[1])
    return tuple(Rival(name, sensors, share, strength) for (name, sensors), share in ranked)


def concerned(places: tuple[int, ...], session: CalibrationSession, *, of_rows: bool) -> tuple[str, ...]:
    """The names of the sensors that a correction concerns; none where it is of rows."""
    return () if of_rows else tuple(session.sensors[i].name for i in places)


def entry_finding(entry: WrongEntry) -> Finding:
    """An entry of the record that the nominal axes show to be wrong."""
    return replace(
        named_cause(entry.cause, (), entry.p_value, entry.strength),
        amplitude=(entry.amplitude,),
        sigma=(entry.sigma,),
        units=entry.cause.units,
    )


def scale_findings(scales: Sequence[CommonScale], session: CalibrationSession) -> tuple[Finding, ...]:
    """A factor that all sensors of a kind share and the applied vector cannot have made, as the change that it is."""
    return tuple(scale_finding(scale, session) for scale in scales)


def scale_finding(scale: CommonScale, session: CalibrationSession) -> Finding:
    """Describes one common factor."""
    m, known = len(scale.sensors), SensorDrift()
    several = len({sensor.kind for sensor in session.sensors}) > 1
    of_kind = say(" of the {kind}s", kind=scale.kind) if several else ""
    change = f"{100 * scale.factor:+.4g}".replace("-", "−")
    return replace(
        named_cause(known, tuple(session.sensors[i].name for i in scale.sensors), scale.p_value, 0.0),
        sentence=say(SCALED, of_kind=of_kind, change=change),
        advice=SCALED_ADVICE,
        strength=abs(scale.factor) / scale.sigma,
        amplitude=(scale.factor, 0.0, 0.0, 0.0) * m,
        sigma=(scale.sigma, 0.0, 0.0, 0.0) * m,
        units=tuple(u if scale.kind == ACCELEROMETER else u.replace("m/s²", "rad/s") for u in known.units) * m,
        nonlinear_each=({},) * m,
    )


def is_beyond_gravity(finding: Finding) -> bool:
    """Whether a finding is a gravity that does not occur on Earth."""
    least, largest = common_factors(ACCELEROMETER, None, None)
    return finding.cause == GravityEntry.identifier and not least <= np.expm1(finding.amplitude[0]) <= largest


def doubted_at_one_place(finding: Finding) -> Finding:
    """A finding about gravity where all sessions state one place, which has one gravity: the change may be theirs."""
    if finding.cause != GravityEntry.identifier or abs(finding.amplitude[0]) <= ONE_PLACE:
        return finding
    drift, again = SensorDrift.identifier, "measure another unit in the same place"
    return replace(
        finding,
        advice=joined(" ", (ONE_PLACE_ADVICE, SCALED_ADVICE)),
        alternatives=(drift, *finding.alternatives),
        separations=(Separation(drift, (), 0.0, again, finding.strength), *finding.separations),
        ranking=tuple(shared(finding, (drift,))),
    )


def wrong_record(axes: ImplausibleAxes | None, session: CalibrationSession) -> tuple[Structure, ...]:
    """Unexplained structure: axes that no sensor can have, so that the record is wrong in an unknown way."""
    if axes is None:
        return ()
    names = tuple(session.sensors[i].name for i in axes.sensors)
    who = "input axes" if names else "the whole block"
    parts = {"who": who, "angle": f"{np.degrees(axes.angle):.0f}"}
    if axes.step is not None:
        where = say(
            "a zero that differs by {step} {unit} between the direct and the flipped run, or an input axis {angle}° "
            "wrong: the two do the same to these readings; repeat both runs without switching off between them",
            step=f"{axes.step:.3g}",
            unit="m/s²" if session.sensors[axes.sensors[0]].kind == ACCELEROMETER else "rad/s",
            angle=f"{np.degrees(axes.angle):.0f}",
        )
        return (Structure(where, names, 0.0, axes.angle / float(np.sqrt(LEAST))),)
    where = say("{who} {angle}° wrong: columns, runs or angles of the record are mixed up", **parts)
    return (Structure(where, names, 0.0, axes.angle / float(np.sqrt(LEAST)), of_record=True),)
