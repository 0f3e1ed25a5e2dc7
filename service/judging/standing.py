"""The verdict of a session under the models that its readings leave standing, beside the one in force."""

from collections.abc import Iterator
from dataclasses import dataclass

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.explanation.accepted import calibrate_extended
from estimator.diagnosis.explanation.temperature import OF_TEMPERATURE
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, CalibrationSession
from service.diagnosis.words.causes import UNKNOWN_CAUSE
from service.judging.judge import judge
from service.sessions.decision import Verdict
from service.types.records import UnitType

MOST_ALTERNATIVES = 3
"""Of the strongest finding, the likeliest ones, that a verdict is taken under: each costs another calibration."""


@dataclass(frozen=True, eq=False)
class Basis:
    """What a session is judged against, whatever the model."""

    reference: Calibration
    unit_type: UnitType
    coverage_factor: float

    def verdict_of(self, calibration: Calibration) -> Verdict:
        """By the same rule as an upload."""
        return judge(calibration, self.reference, self.unit_type, self.coverage_factor).verdict


@dataclass(frozen=True)
class Otherwise:
    """The verdict under another model than the one in force."""

    causes: tuple[str, ...]
    """That are in that model, identifiers; empty for the baseline."""
    sensors: tuple[str, ...]
    """That its first cause acts on."""
    verdict: Verdict
    named: bool = False
    """Whether it is the model with the causes that the diagnosis names."""


def verdicts_under_alternatives(
    session: CalibrationSession, findings: tuple[Finding, ...], basis: Basis
) -> Iterator[Otherwise]:
    """Under each of the likeliest alternatives of the strongest finding, in its place beside the other names.

    None where the record is wrong: the session is to be uploaded again. None of an alignment: it takes off what is
    looked for in it. None of what only several sessions show together: this one cannot fit it.
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
            own = () if name == UNKNOWN_CAUSE else ((name, _sensors(name, first)),)
            causes = (*own, *others)
            verdict = basis.verdict_of(calibrate_extended(session, causes))
            yield Otherwise(tuple(cause for cause, _ in causes), own[0][1] if own else (), verdict)


def _of_the_session(first: Finding) -> tuple[str, ...]:
    """Alternatives that a model of the session can hold: what temperature did between sessions it cannot show."""
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
