"""What speaks against a verdict, each in a clause that stands after ``but``, and what to do about it."""

from collections.abc import Sequence

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Structure
from service.measures import COVERAGE, HARD, THIN, deviation_measure, in_measure, measured, number
from service.records.decision import Verdict
from service.words.causes import cause_on, choice_of
from service.words.conditions import condition_of
from service.words.names import PARAMETER_NAMES
from service.words.structures import MIXED_UP, UNEXPLAINED

REPEAT = "repeat the session"
CORRECT = "correct the file and upload it again"
STAND = "put the stand right and repeat the session"
FIXTURE = "seat the block again and repeat the session"
RESTATE = "state the errors that the readings have and upload the file again"
ADD = "add positions"
REPORT = "see what its diagnosis says"
ADVICE = {"record": CORRECT, "stand": STAND, "fixture": FIXTURE}
"""By what a cause is of; of a sensor, a session is repeated first."""
TOO_FEW = "it was not checked for causes, because it has too few positions"
LOOKING = "causes are still being looked for"
AGAIN = "ask again in some seconds"
FAILED = "it was not checked for causes"


def advice_on_structure(structure: Structure) -> str:
    """What to do about what no known cause explains: what all sensors show is none of theirs."""
    return REPEAT if structure.sensors else STAND


def advice_on(cause: str) -> str:
    """What to do about a named cause, in a clause."""
    known = find(cause)
    return REPEAT if known is None else ADVICE.get(known.scope, REPEAT)


def named(finding: Finding, size: str) -> str:
    """``the zero of A2 jumps once and stays (51 ± 4 µg, tolerance 50 µg)``; of a choice its names."""
    what = choice_of(finding) if finding.alternatives else finding.sentence
    return f"{within(what)}{f' ({size})' if size else ''}"


def unexplained(structures: Sequence[Structure], size: str) -> str:
    """``something is there in A3 that no known cause explains (20 µg, tolerance 50 µg)``."""
    first = structures[0]
    if first.of_record:
        return within(MIXED_UP)
    where = f" in {', '.join(first.sensors)}" if first.sensors else " in all sensors"
    return f"{within(UNEXPLAINED).replace('something is there', f'something is there{where}')} ({size})"


def otherwise(verdict: Verdict, causes: Sequence[str], sensors: Sequence[str], *, named: bool = False) -> str:
    """``it would be unfit with warm up (A2) in the model``; without a cause: if none of those named acted.

    ``named``: the causes are those that the diagnosis names.
    """
    word = condition_of(verdict).word.lower()
    if named:
        return f"it would be {word} with what was found in the model"
    if not causes:
        return f"it would be {word} if what acts were none of the known causes"
    names = [cause_on(causes[0], sensors), *(cause_on(cause, ()) for cause in causes[1:])]
    return f"it would be {word} with {' and '.join(names)} in the model"


def size_in_words(kind: str, parameter: str, size: tuple[float, float | None], tolerance: float) -> str:
    """``51 ± 4 µg, tolerance 50 µg``, with U at k = 2; SI in."""
    value, sigma = size
    measure = deviation_measure(kind, parameter, max(value, tolerance))
    allowed = f"tolerance {number(in_measure(tolerance, measure))}{THIN}{measure.label}"
    if sigma is None:
        return f"about {number(float(f'{value * measure.factor:.2g}'))}{THIN}{measure.label}, {allowed}"
    return f"{measured(value, COVERAGE * sigma, measure)}, {allowed}"


def elsewhere(outside: float, now: float, covered: tuple[float, float], worth: str) -> str:
    """``it was measured at 35 °C, 13 °C above its reference and earlier sessions (19–22 °C)``, and what that means."""
    here, by, at = _degrees(now), _degrees(abs(outside)), _between(*covered)
    if outside > 0:
        away = f"it was measured at {here}, {by} above its reference and earlier sessions ({at})"
    else:
        away = f"it was measured at {here}, {by} below its reference and earlier sessions ({at})"
    if worth:
        return f"{away}, and the temperature alone may be worth {worth}"
    return f"{away}, and the temperature alone can make or hide a change"


def worth_in(parameter: str, sensor: str, size: str) -> str:
    """``A2 bias: 80 ± 10 µg, tolerance 50 µg``."""
    return f"{sensor} {PARAMETER_NAMES[parameter]}: {size}"


def _between(lowest: float, highest: float) -> str:
    """``19–22 °C``."""
    low, high = number(lowest, 0), number(highest, 0)
    return _degrees(lowest) if low == high else f"{low}–{_degrees(highest)}"


def at_about(celsius: float) -> str:
    """Where to measure again."""
    return f"measure again at about {_degrees(celsius)}, or calibrate over temperature"


def _degrees(celsius: float) -> str:
    return f"{number(celsius, 0)}{HARD}°C"


def within(sentence: str) -> str:
    """A sentence as a clause within another: names of sensors keep their capitals."""
    head, _, rest = sentence.rstrip(".").partition(" ")
    plain = head[1:].islower() or len(head) == 1
    return f"{head.lower() if plain else head} {rest}".rstrip()
