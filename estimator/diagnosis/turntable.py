"""Diagnosis of an alignment on a turntable: lever arms, and other effects of the turns."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from estimator.alignment.align import align, prepared
from estimator.alignment.as_calibration import alignment_calibration, settled
from estimator.alignment.held_out import HeldOutPrediction, held_out, prediction
from estimator.alignment.lever_arms import DECISIVE, FEWEST, LEVEL, FittedLeverArm, LeverArms, lever_arms
from estimator.alignment.results import AlignmentResult
from estimator.applied_vector import STANDARD_GRAVITY
from estimator.causes.catalogue import UNEXPLAINED
from estimator.causes.turntable import LeverArm as Cause
from estimator.diagnosis.explanation.detection_limits import required
from estimator.diagnosis.results import Diagnosis, Finding, Gain, Limit, Rival, Score, Separation, Structure
from estimator.message import joined, say, say_count
from estimator.results import ARCSEC, COVERAGE
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.significance import critical_chi2, family_wise

CENTIMETRE, MICRO_G = 0.01, STANDARD_GRAVITY * 1e-6
"""m, m/s²."""
CAUSE = Cause()
CALLED = {"vibration": "vibration-rectification", "wobble": "axis-wobble", "delay or rate": UNEXPLAINED}
"""The catalogue's names of rivals; it has none of a delay."""
SEPARATING = {
    "vibration": (
        "measure the position of the sensor with a ruler, or mount it so that its lever arm is across its input axis"
    ),
    "wobble": "turn in both directions, with stops a quarter turn apart",
    "delay or rate": "turn in the other direction as well",
}
"""Measurements that would tell a rival from a lever arm."""
WHERE = {
    "vibration": "a shift while the table turns, as from a vibrating bearing",
    "wobble": "a tilt of the turn axis while the table turns",
    "delay or rate": "readings that lag while the table turns, or follow its rate",
}
"""Descriptions of a rival that fits far better than a lever arm."""
COARSE = 5e-4
"""m of uncertainty from which a tenth of a centimetre is fine enough."""
ALIKE = (
    "The part of a lever arm along the input axis acts as the square of the turn rate; anything else that does, such "
    "as rectified bearing vibration, is included in it. The part across the input axis is determined by starts and "
    "stops only."
)
BEYOND = "while the table turns, beyond any lever arm"


def diagnose_alignment(session: CalibrationSession) -> Diagnosis:
    """The lever arms of a session of programme rotation-alignment.

    Raises
    ------
    ScheduleError : the session cannot be aligned.
    """
    arms = lever_arms(prepared(session))
    without, result = align(session, lever_arms=False), align(session)
    rows = settled(result) & settled(without)
    return Diagnosis(
        unit=session.unit,
        findings=tuple(_findings(arms)),
        structures=tuple(_structures(arms)),
        gain=_gain(arms),
        limits=(_limit(arms),),
        baseline=alignment_calibration(without, rows),
        calibration=alignment_calibration(result, rows),
        notes=tuple(_notes(arms, without, result)),
    )


def _findings(arms: LeverArms) -> Iterator[Finding]:
    """One a sensor; where the file states positions and only two show, one of both: either may sit elsewhere."""
    named = [(arm, _finding(arm, arms)) for arm in arms.named]
    if not (arms.stated and named and len(arms.estimates) < FEWEST):
        yield from (finding for _, finding in named)
        return
    arm, first = max(named, key=lambda pair: pair[1].strength)
    sensors = tuple(estimate.sensor.name for estimate in arms.estimates)
    sentence = CAUSE.separation_sentence(sensors, _centimetres(*arm.distance))
    yield replace(first, sentence=sentence, sensors=sensors, amplitude=(), sigma=(), units=())


def _finding(arm: FittedLeverArm, arms: LeverArms) -> Finding:
    name, (length, sigma) = arm.sensor.name, arm.distance
    length_text = _centimetres(length, sigma)
    sentence = (
        CAUSE.contradiction_sentence(name, length_text) if arms.stated else CAUSE.lever_sentence(name, length_text)
    )
    return Finding(
        cause=CAUSE.identifier,
        sentence=sentence,
        advice=CAUSE.correct if arms.stated else CAUSE.advice,
        sensors=(name,),
        p_value=family_wise(arm.response.p_value("lever arm"), len(arms.estimates)),
        strength=_strength(arm, "lever arm"),
        amplitude=tuple(map(float, arm.place)),
        sigma=tuple(map(float, np.sqrt(np.diag(arm.covariance)))),
        units=CAUSE.units,
        alternatives=tuple(dict.fromkeys(CALLED[rival] for rival in arm.rivals)),
        separations=tuple(_separation(arm, rival) for rival in arm.rivals),
        ranking=tuple(_ranking(arm, len(arms.pieces.time))),
    )


def _centimetres(length: float, sigma: float) -> str:
    """``4.1 ± 0.4 cm``: U = 2σ, with two digits of it at most."""
    expanded = COVERAGE * sigma
    digits = 1 if expanded >= COARSE else 2
    return f"{length / CENTIMETRE:.{digits}f} ± {expanded / CENTIMETRE:.{digits}f} cm"


def _strength(arm: FittedLeverArm, model: str) -> float:
    return float(np.sqrt(max(arm.response.drop[model][0], 0.0)))


def _separation(arm: FittedLeverArm, rival: str) -> Separation:
    now = _strength(arm, say("lever arm beside {rival}", rival=rival))
    return Separation(CALLED[rival], (arm.sensor.name,), now, SEPARATING[rival], None)


def _ranking(arm: FittedLeverArm, pieces: int) -> Iterator[Rival]:
    """Shares by BIC."""
    names = {"lever arm": CAUSE.identifier, **CALLED}
    worth = np.array([arm.response.worth(model, pieces) for model in names])
    share = np.exp(0.5 * (worth - worth.max()))
    lines = zip(names, share / share.sum(), strict=True)
    for model, probability in sorted(lines, key=lambda line: -line[1]):
        yield Rival(names[model], (arm.sensor.name,), float(probability), _strength(arm, model))


def _structures(arms: LeverArms) -> Iterator[Structure]:
    level = LEVEL / max(len(arms.estimates), 1)
    for arm in arms.estimates:
        who = (arm.sensor.name,)
        if arm.other:
            yield Structure(WHERE[arm.other], who, arm.response.p_value(arm.other), _strength(arm, arm.other))
        elif arm.more < level:
            yield Structure(BEYOND, who, arm.more, _strength(arm, "beyond"))


def _gain(arms: LeverArms) -> Gain:
    before, after = (_score(prediction(arms, named=named)) for named in (False, True))
    return Gain(before, after, held_out(arms), None)


def _score(prediction: HeldOutPrediction) -> Score:
    return Score(
        rms=prediction.rms,
        chi2_per_dof=prediction.chi2,
        log_score=prediction.log_score,
        rms_by_kind={ACCELEROMETER: prediction.rms},
        rms_by_sensor={ACCELEROMETER: prediction.rms_by_sensor},
    )


def _limit(arms: LeverArms) -> Limit:
    if not arms.estimates:
        return Limit(CAUSE.identifier, None, CAUSE.units, "every accelerometer points along the turn axis")
    need = required(1, critical_chi2(LEVEL / len(arms.estimates), 1))
    sigma = np.max([np.sqrt(np.diag(arm.covariance)) for arm in arms.estimates], axis=0)
    return Limit(CAUSE.identifier, tuple(map(float, need * sigma)), CAUSE.units, "")


def _notes(arms: LeverArms, without: AlignmentResult, result: AlignmentResult) -> Iterator[str]:
    if arms.upright:
        yield say_count(
            "{upright} points along the turn axis: its position is not observable. Nor is any sensor's position "
            "along the axis.",
            "{upright} point along the turn axis: their positions are not observable. Nor is any sensor's position "
            "along the axis.",
            len(arms.upright),
            upright=joined(" and ", arms.upright),
        )
    if arms.origin is not None:
        place, covariance = arms.origin
        length, sigma = float(np.hypot(*place)), float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
        if length > DECISIVE**0.5 * sigma:
            text = _centimetres(length, sigma)
            yield say(
                "The origin of the stated positions lies {text} from the turn axis; this is corrected.", text=text
            )
    if arms.named:
        yield say(
            "Lever arms are part of every alignment's model. Without them {without}.",
            without=_error_without(without, result),
        )
        yield ALIKE


def _error_without(without: AlignmentResult, result: AlignmentResult) -> str:
    """The size of the errors of biases and mounting angles without the correction, as a message."""
    moved = {name: _value(without, name) - _value(result, name) for name in ("nabla_x", "nabla_y", "E_xz", "E_yz")}
    zeros = max(abs(moved["nabla_x"]), abs(moved["nabla_y"])) / MICRO_G
    mounting = max(abs(moved["E_xz"]), abs(moved["E_yz"])) / ARCSEC
    parts = {"zeros": f"{zeros:.1f}", "mounting": f"{mounting:.1f}"}
    return say("a bias would be wrong by {zeros} µg and a mounting error by {mounting}″", **parts)


def _value(result: AlignmentResult, name: str) -> float:
    return float(result.estimate[result.names.index(name)])
