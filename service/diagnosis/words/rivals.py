"""What else a finding could be: its alternatives, how to distinguish them, and the ranking of all causes."""

from collections.abc import Iterator
from dataclasses import dataclass

from estimator.diagnosis import Finding
from estimator.diagnosis.results import Separation
from estimator.message import say
from service.diagnosis.words.causes import SHOWN_SHARE, UNKNOWN_CAUSE, cause_on, percent, share_of
from service.kit.measures import HARD, number

DISTINGUISHED = 3.0
"""Expected separation, standard errors, below which a measurement would not help: the estimator's own bound."""
ALWAYS_SHOWN = 3
"""Lines of the ranking that are shown however small their share."""


IF_IT_COMES_BACK = "repeat the session: a cause that is named rightly comes back"


@dataclass(frozen=True)
class Choice:
    """One of several causes that this session cannot distinguish."""

    cause: str
    name: str
    share: str
    """Among all known causes."""
    now: str
    """How far it is from the first one in this session."""
    measurement: str
    """What would distinguish it from the first one."""


@dataclass(frozen=True)
class Bar:
    """One line of the ranking of causes."""

    name: str
    percent: str
    width: float
    """0 to 100."""


def choices_of(finding: Finding) -> Iterator[Choice]:
    """The named cause and its alternatives."""
    apart = {separation.cause: separation for separation in finding.separations}
    for name in (finding.cause, *finding.alternatives) if finding.alternatives else ():
        if name == UNKNOWN_CAUSE:
            yield Choice(name, cause_on(name, finding.sensors), "–", "", IF_IT_COMES_BACK)
            continue
        share = share_of(name, finding)
        yield Choice(name, cause_on(name, finding.sensors), share, *_apart(apart.get(name)))


def _apart(separation: Separation | None) -> tuple[str, str]:
    """How far a rival is now, and the measurement that would distinguish it with what to expect of it."""
    if separation is None:
        return "", ""
    expected = separation.then or 0.0
    if not separation.measurement or expected < DISTINGUISHED:
        return _sigmas(separation.now), "no further session of this kind would; look at the hardware"
    return _sigmas(separation.now), say(
        "{measurement} (expected {expected} apart)", measurement=separation.measurement, expected=_sigmas(expected)
    )


def _sigmas(value: float) -> str:
    return f"{number(value, 1)}{HARD}σ"


def ranking_of(finding: Finding) -> Iterator[Bar]:
    """Rival causes with their shares; those that are out of the question are left out."""
    for place, rival in enumerate(finding.ranking):
        if place < ALWAYS_SHOWN or rival.probability > SHOWN_SHARE:
            name = cause_on(rival.cause, rival.sensors)
            yield Bar(name, percent(rival.probability), 100 * rival.probability)
