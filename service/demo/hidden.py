"""Effects that the baseline simulation lacks, hidden in demonstration sessions for the diagnosis to find."""

from dataclasses import dataclass

import numpy as np

from estimator.causes import Signature, cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.hiding import with_input
from estimator.session import CalibrationSession


@dataclass(frozen=True)
class Hidden:
    """One effect in a member's latest session."""

    cause: str
    amplitude: tuple[float, ...]
    """SI, as the catalogue counts it."""
    sensor: int | None = None
    """Counted from 0; None for an effect of the stand."""


def with_effect(session: CalibrationSession, hidden: Hidden) -> CalibrationSession:
    """The session with the effect in its readings."""
    setting, known = baseline_of(session).setting, cause(hidden.cause)
    assert isinstance(known, Signature)
    place = () if hidden.sensor is None else (hidden.sensor,)
    shape = next(shape for shape in known.shapes(setting) if shape.sensors == place)
    added = shape.columns @ np.array(hidden.amplitude)
    return with_input(session, setting, added)
