"""A finding, and an imu-diagnosis/1 that holds it as an earlier version wrote it."""

import json
from typing import Any

from estimator import calibrate
from estimator.diagnosis import Finding
from estimator.diagnosis.results import ParitySplit, Rival, Separation
from estimator.reading import read_session
from tests.builders import accelerometer_block

JUMP = Finding(
    cause="bias-jump", sensors=("A1", "A2"), amplitude=(3e-4, 2e-4), sigma=(1e-5, 1e-5), units=("m/s²", "m/s²"),
    nonlinear_each=({"row": 14.0}, {"row": 20.0}), p_value=2.5e-5, strength=8.0,
    alternatives=("warm-up",), separations=(Separation("warm-up", ("A1", "A2"), 1.5, "repeat the session", 4.5),),
    ranking=(Rival("bias-jump", ("A1", "A2"), 0.7, 8.0), Rival("warm-up", ("A1", "A2"), 0.3, 7.8)),
    sentence="The zero of A1 and A2 jumped.", advice="Look for a shock.",
    parity=ParitySplit(0.5, 900.0, 40.0, 800.0, 30.0), new=True,
)  # fmt: skip
"""Two sensors jumped at rows of their own; a warm-up fits as well."""
SCORE = {"rms": 2e-4, "chi2_per_dof": 3.0, "log_score": -1.0}


def earlier_document(**changes: Any) -> dict[str, Any]:
    """A document of a version that held no size against the session before and gave the shape of the first sensor
    alone.
    """
    calibration = calibrate(read_session(accelerometer_block())).to_dict()
    finding = {name: value for name, value in JUMP.to_dict().items() if name != "nonlinear_each"}
    document = {
        "format": "imu-diagnosis/1", "unit": "BA-017", "findings": [finding | changes], "unexplained": False,
        "structures": [], "gain": {"before": SCORE, "after": SCORE, "held_out": "positions"}, "limits": [],
        "calibration": calibration, "residuals_before": calibration["residuals"], "notes": [],
    }  # fmt: skip
    plain: dict[str, Any] = json.loads(json.dumps(document))
    return plain
