"""Effects that settle after switching on, counted from that moment where the session states it.

An exponential looks the same from any origin: only its amplitude depends on it. Counted from switching on, amplitude
and time constant are those of the unit, which its next session has again, and say how long to wait.
"""

from dataclasses import replace

from estimator.causes import find
from estimator.diagnosis.results import Finding
from estimator.message import say
from estimator.moments import duration
from estimator.session import CalibrationSession

WAIT = 3.0
"""Time constants in which all but a twentieth dies away."""


def timed_from_power_on(finding: Finding, session: CalibrationSession) -> Finding:
    """The finding with when its amplitudes are counted from, and how long to wait; others as they are."""
    cause, begun = find(finding.cause), session.time_since_power_on
    if cause is None or not cause.since_power_on or begun is None:
        return finding
    longest = max(shape["s"] for shape in finding.nonlinear_each)
    advice = say(
        "Begin {wait} or more after switching on, or record the temperature of the unit: this session began after "
        "{begun}, and 95 % of the effect dies away within three time constants.",
        wait=duration(begun + WAIT * longest),
        begun=duration(begun),
    )
    return replace(finding, advice=advice, since_power_on=begun)
