"""Reasons and reservations of a verdict, in words."""

from collections.abc import Sequence

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Structure
from estimator.message import capitalised, joined, say, uncapitalised, without_stop
from estimator.parity import ParityResult
from estimator.parity.results import SEVERAL, Candidate
from estimator.results import Calibration, HandTurns, TurnsOutcome
from service.diagnosis.words.causes import cause_on, choice_of
from service.diagnosis.words.findings import MIXED_UP
from service.fleet.condition import UnitSummary
from service.judging.fault_words import said_of
from service.judging.temperature_words import at_about, in_degrees, law_in_words
from service.kit.measures import (
    COVERAGE,
    PARAMETER_NAMES,
    THIN,
    deviation_measure,
    in_measure,
    in_words,
    measured,
    number,
)
from service.sessions.decision import Decision, Opening, ServiceFault, Verdict, worst_of
from service.sessions.doubt import Reservations
from service.sessions.words.advice import left_open
from service.sessions.words.conditions import Condition, but, condition_of

REPEAT = "repeat the session"
CORRECT = "correct the file and upload it again"
STAND = "correct the stand and repeat the session"
FIXTURE = "remount the block and repeat the session"
RESTATE = "state the true standard errors and upload the file again"
ADD = "add positions"
ACCEPT = "accept it into the model, or have the sensor checked"
REPORT = "see its diagnosis"
ADVICE = {"record": CORRECT, "stand": STAND, "fixture": FIXTURE}
"""Advice by the scope of a cause; for a passing effect in a sensor, the session is repeated first."""
TOO_FEW = "causes were not checked because of too few positions"
AGAIN = "ask again in a few seconds"
FAILED = "causes were not checked"


def advice_on_structure(structure: Structure) -> str:
    """The advice on a structure that no known cause explains: one common to all sensors belongs to none of them."""
    return REPEAT if structure.sensors else STAND


def advice_on(cause: str, *others: str) -> str:
    """The advice on a named cause, in a clause; ``others``: causes that the session cannot tell from it. A property of
    the sensor comes back in a repeated session.
    """
    known = [find(name) for name in (cause, *others)]
    if all(one is not None and one.lasts for one in known):
        return ACCEPT
    return REPEAT if known[0] is None else ADVICE.get(known[0].scope, REPEAT)


def named(finding: Finding, size: str) -> str:
    """``the bias of A2 has one step (51 ± 4 µg, tolerance 50 µg)``; of a choice its names."""
    cause_text = choice_of(finding) if finding.alternatives else finding.sentence
    return say("{limit}{size}", limit=within(cause_text), size=say(" ({size})", size=size) if size else "")


def unexplained(structures: Sequence[Structure], size: str) -> str:
    """``an effect in A3 that no known cause explains (20 µg, tolerance 50 µg)``."""
    first = structures[0]
    if first.of_record:
        return within(MIXED_UP)
    where = say(" in {sensors}", sensors=joined(", ", first.sensors)) if first.sensors else " in all sensors"
    return say("an effect{where} that no known cause explains ({size})", where=where, size=size)


def otherwise(verdict: Verdict, causes: Sequence[str], sensors: Sequence[str], *, named: bool = False) -> str:
    """``unfit with warm up (A2) corrected``; without a cause: if none of those named acted.

    ``named``: the causes are those that the diagnosis names.
    """
    word = uncapitalised(condition_of(verdict).word)
    if named:
        return say("{word} with these effects corrected", word=word)
    if not causes:
        return say("{word} if the cause is not a known one", word=word)
    names = [cause_on(causes[0], sensors), *(cause_on(cause, ()) for cause in causes[1:])]
    return say("{word} with {names} corrected", word=word, names=joined(" and ", names))


def size_in_words(kind: str, parameter: str, size: tuple[float, float | None], tolerance: float) -> str:
    """``51 ± 4 µg, tolerance 50 µg``, with U at k = 2; SI in."""
    value, sigma = size
    measure = deviation_measure(kind, parameter, max(value, tolerance))
    parts = {"tolerance": number(in_measure(tolerance, measure)), "thin_space": THIN, "label": measure.label}
    allowed = say("tolerance {tolerance}{thin_space}{label}", **parts)
    if sigma is None:
        return say(
            "about {value}{thin_space}{label}, {tolerance}",
            value=number(float(f"{value * measure.factor:.2g}")),
            thin_space=THIN,
            label=measure.label,
            tolerance=allowed,
        )
    return say("{value}, {tolerance}", value=measured(value, COVERAGE * sigma, measure), tolerance=allowed)


def turns_in_words(turns: HandTurns) -> str:
    """``its gyros have no scale factors: their turns scatter 15 times as much as the noise``."""
    match turns.outcome:
        case TurnsOutcome.AVERAGED:
            return "its gyros have no scale factors: the log was averaged while it was read, and its turns with it"
        case TurnsOutcome.UNDETERMINED:
            return "its gyros have no scale factors: its turns do not determine them"
        case TurnsOutcome.SCATTERED:
            scatter = number(turns.scatter, 1)
            return say(
                "its gyros have no scale factors: their turns scatter {scatter} times as much as the noise",
                scatter=scatter,
            )
    return say(
        "the turns of its gyros scatter {scatter} times as much as the noise, which their U includes",
        scatter=number(turns.scatter, 1),
    )


def advice_on_turns(turns: HandTurns) -> str:
    """The advice that gives gyros their scale factors, in a clause."""
    match turns.outcome:
        case TurnsOutcome.AVERAGED:
            return "send a shorter log"
        case TurnsOutcome.UNDETERMINED:
            return "turn it by 60° or more between rests, about axes that differ and within the range of the gyros"
    return "log faster, all sensors at the same instants, and turn it and set it down more gently"


def within(sentence: str) -> str:
    """A sentence as a clause within another: names of sensors keep their capitals."""
    clause, head = without_stop(sentence), sentence.split()[0].rstrip(".")
    return uncapitalised(clause) if head[1:].islower() or len(head) == 1 else clause


FIRST_SESSION = "First session of this unit: later sessions are judged against it."
NEW_EPOCH = "First session after a service: later sessions are judged against it."
CHOSEN = "Chosen as the reference: the unit's other sessions are judged against it."
OPENINGS = {Opening.FIRST: FIRST_SESSION, Opening.SERVICE: NEW_EPOCH, Opening.CHOSEN: CHOSEN}
NOTHING_JUDGED = "Not judged: no parameter of this session has a tolerance."
ALL_PASS = "Every parameter is within its tolerance by more than U; closest to it: {closest}."


def by_defaults(unit_type: str) -> str:
    """The sentence that the tolerances of a type are nobody's."""
    return say(
        "Nobody has entered tolerances for {unit_type}: the defaults are used, or 3 U where U of the "
        "reference exceeds them.",
        unit_type=unit_type,
    )


def verdict_in_words(condition: Condition, reservations: Reservations) -> str:
    """A verdict with its reservations: ``Fit, but the bias of A2 has one step: repeat the session``."""
    return say("{word}{but}", word=condition.word, but=but(reservations)) if reservations != () else condition.word


def unit_in_words(unit: UnitSummary) -> str:
    """The verdict of a unit's latest session in words."""
    return verdict_in_words(condition_of(unit.verdict, is_reference=unit.is_reference), unit.reservations)


def first_in_words(calibration: Calibration, opening: Opening) -> str:
    """The sentence that a session is the reference, with the parameters that it leaves open."""
    return joined(" ", filter(None, (OPENINGS[opening], left_open(calibration))))


def reason(decisions: tuple[Decision, ...], blind: str = "") -> str:
    """One sentence on the worst parameter, in people's units; ``blind`` says why a session gives no uncertainty."""
    worst = worst_of(decisions)
    if worst is None:
        return blind or NOTHING_JUDGED
    if blind and worst.expanded is None:
        return blind
    return joined(" ", filter(None, (_sentence(worst, decisions), _by_law(worst, decisions))))


def _by_law(worst: Decision, decisions: tuple[Decision, ...]) -> str:
    """The effect of temperature on the worst parameter, or else on the one most affected; empty where nothing was
    corrected.
    """
    taken = [(decision, step) for decision in decisions if (step := decision.temperature_correction) is not None]
    most = max(taken, key=lambda pair: (pair[0] is worst, abs(pair[1].worth) / pair[0].tolerance), default=None)
    return "" if most is None else law_in_words(*most)


def _sentence(worst: Decision, decisions: tuple[Decision, ...]) -> str:
    place = say("{sensor} {worst}", sensor=worst.sensor, worst=_name(worst))
    if worst.deviation is None or worst.expanded is None:
        return _unseen(worst, decisions)
    moved = _words(worst, worst.deviation, signed=worst.parameter != "axis")
    spread, allowed = _words(worst, worst.expanded), _words(worst, worst.tolerance)
    parts = {"place": place, "change": moved, "spread": spread, "tolerance": allowed}
    match worst.verdict:
        case Verdict.PASS:
            closest = say("{place}, changed by {change} (U {spread}), tolerance ±{tolerance}", **parts)
            return say(ALL_PASS, closest=closest)
        case Verdict.FAIL:
            return say("{place} changed by {change} (U {spread}), beyond the tolerance of ±{tolerance}.", **parts)
        case Verdict.CONDITIONAL_FAIL:
            return say(
                "{place} changed by {change} (U {spread}), beyond the tolerance of ±{tolerance} by less than U.",
                **parts,
            )
        case Verdict.CONDITIONAL_PASS:
            return say(
                "{place} changed by {change} (U {spread}), within the tolerance of ±{tolerance} by less than U.",
                **parts,
            )
    return _too_uncertain(worst, **parts)


MORE_READINGS = "measure more positions or average longer"
MEASURE_AGAIN = "measure again"
OTHER_REFERENCE = "choose a reference that has it"
ADD_POSITIONS = "add positions"


def _too_uncertain(worst: Decision, *, change: str, **known: str) -> str:
    """``known``: its place, U and tolerance."""
    step = worst.temperature_correction
    if step is not None and worst.expanded is not None and worst.expanded > worst.tolerance:
        return say(
            "{place} has U {spread} at {reference}, more than its tolerance of ±{tolerance}: {remedy}.",
            **known,
            reference=in_degrees(step.reference_temperature),
            remedy=at_about(step.reference_temperature),
        )
    if worst.expanded is not None and worst.expanded > worst.tolerance:
        return say(
            "{place} has U {spread}, more than its tolerance of ±{tolerance}: {remedy}, or set a wider tolerance.",
            **known,
            remedy=MORE_READINGS,
        )
    return say(
        "{place} changed by {change} (U {spread}), beyond the tolerance of ±{tolerance}, but noise alone can do this "
        "to one of so many parameters: {remedy}.",
        **known,
        remedy=MEASURE_AGAIN,
        change=change,
    )


def _unseen(worst: Decision, decisions: tuple[Decision, ...]) -> str:
    sensors = [d.sensor for d in decisions if d.parameter == worst.parameter and d.deviation is None]
    named = joined(", ", sensors[:6]) + (
        say(" and {sensors} more", sensors=len(sensors) - 6) if len(sensors) > 6 else ""
    )
    missing, remedy = "is not in the reference session", OTHER_REFERENCE
    if worst.value is None:
        missing, remedy = "is not observable in this session", ADD_POSITIONS
    parts = {"worst": capitalised(_name(worst)), "named": named, "missing": missing, "remedy": remedy}
    return say("{worst} of {named} {missing}: {remedy}.", **parts)


def _name(decision: Decision) -> str:
    return PARAMETER_NAMES[decision.parameter]


def _words(decision: Decision, si: float, *, signed: bool = False) -> str:
    return in_words(decision.kind, decision.parameter, si, signed=signed)


ALIKE = "with one another as at the calibration"
SAME = say("The sensors agree {alike}", alike=ALIKE)
CHANGED = say("The sensors do not agree {alike}", alike=ALIKE)
TOO_MUCH_MOTION = "Too much motion for a verdict"
REST = 15
"""Blocks at rest that are asked for: twelve are needed, and the first and the last are never whole."""
MOSTLY_MOTION = 0.5
"""Share of what hides a change from which stillness helps more than length."""
MOST_CANDIDATES = 6
"""Sensors that a sentence lists: a block of the common kind has no more."""
LEAST_SHARE = 1e-3
"""Share of the samples below which the share itself adds nothing."""


def recording_in_words(
    result: ParityResult, decisions: tuple[Decision, ...], faults: tuple[ServiceFault, ...] = ()
) -> str:
    """The result of a recording in service, and the parameters that it could not judge."""
    if faults:
        return said_of(faults)
    found = found_in_words(result)
    unseen = [d for d in decisions if d.verdict is Verdict.UNDECIDABLE]
    if not decisions:
        return say("{result}. {nothing_judged}", result=found, nothing_judged=NOTHING_JUDGED)
    if result.detected:
        return say("{result}.", result=found)
    if not unseen:
        allowed = ", motion taken into account" if result.moving else ""
        return say(
            "{same}{allowed}: a change as large as any tolerance would have been detected.", same=SAME, allowed=allowed
        )
    return (
        say("{result}.", result=found)
        if result.moving
        else say("{result}, but {unseen}.", result=found, unseen=_limit(unseen, result))
    )


def found_in_words(result: ParityResult) -> str:
    """The result apart from faults, without its full stop."""
    if result.moving:
        return say(
            "{too_much_motion}: the sensors disagree, possibly because of lever arms, delays between channels or "
            "vibration; {result}",
            too_much_motion=TOO_MUCH_MOTION,
            result=stillness(result),
        )
    if not result.detected:
        return SAME
    best = result.candidates[0]
    if not result.explained:
        return say(
            "No single sensor explains the change; {sensor} explains most of it. Calibrate the unit before use",
            sensor=best.sensor,
        )
    if result.isolated is not None:
        moved = joined(" or ", (_moved(c, result.kind) for c in result.candidates))
        said = clipped_in_words(result, best.sensor)
        parts = {"sensor": best.sensor, "change": moved, "notes": said and say("; {notes}", notes=said)}
        return say("{sensor} has changed since the calibration: {change}; the others agree{notes}", **parts)
    listed = joined(
        " or ",
        (
            say("{sensor} ({parameter_names})", sensor=c.sensor, parameter_names=PARAMETER_NAMES[c.kind])
            for c in result.candidates[:MOST_CANDIDATES]
        ),
    )
    return say(
        "A parameter has changed since the calibration; this recording cannot tell which: {listed}", listed=listed
    )


def stillness(result: ParityResult) -> str:
    """The advice by which motion does not hide a change."""
    seconds = REST * (result.block_seconds or 1.0)
    return say(
        "hold the unit still for {seconds} s while recording, or state where its sensors are (position_m) and record "
        "its gyros too",
        seconds=f"{seconds:.0f}",
    )


def clipped_in_words(result: ParityResult, sensor: str) -> str:
    """The share of samples at which a channel stood at the end of its range; empty for one that did not."""
    share = result.clipped.get(sensor)
    return (
        ""
        if share is None
        else say("{sensor} was at the end of its range in {share} of the samples", sensor=sensor, share=percent(share))
    )


def percent(share: float) -> str:
    """A share, dimensionless, as people say it."""
    return f"{number(100 * share, 1)} %" if share >= LEAST_SHARE else "less than 0.1 %"


def _moved(candidate: Candidate, kind: str) -> str:
    if candidate.kind == SEVERAL:
        return PARAMETER_NAMES[SEVERAL]
    size = candidate.amplitude[0]
    if candidate.kind == "axis":
        size = sum(turn**2 for turn in candidate.amplitude) ** 0.5
    moved = in_words(kind, candidate.kind, size, signed=candidate.kind != "axis")
    sigma = max(candidate.sigma)
    return say(
        "{parameter} {change} (U {expanded})",
        parameter=PARAMETER_NAMES[candidate.kind],
        change=moved,
        expanded=in_words(kind, candidate.kind, COVERAGE * sigma),
    )


def _limit(unseen: list[Decision], result: ParityResult) -> str:
    """The parameter that is furthest from being seen."""
    blind = [d for d in unseen if d.critical is None]
    if blind:
        names = {PARAMETER_NAMES[d.parameter] for d in blind}
        return say(
            "{names} cannot be observed without motion: turn the unit while recording",
            names=joined(" and ", sorted(names)),
        )
    worst = max(unseen, key=lambda d: (d.critical or 0.0) / d.tolerance)
    needed = in_words(worst.kind, worst.parameter, worst.critical or 0.0)
    allowed = in_words(worst.kind, worst.parameter, worst.tolerance)
    longer = "record longer, turn more slowly, or set a wider tolerance"
    return say(
        "a change of {sensor} {parameter_names} is detected from {change} on, tolerance ±{tolerance}: {longer}",
        sensor=worst.sensor,
        parameter_names=PARAMETER_NAMES[worst.parameter],
        change=needed,
        tolerance=allowed,
        longer=stillness(result) if result.motion_share > MOSTLY_MOTION else longer,
    )
