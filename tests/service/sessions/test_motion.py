"""Common motion of all sensors in plain sentences."""

import numpy as np

from estimator.health.common_motion import CommonMotion
from estimator.results import ARCSEC
from service.sessions.words.motion import motions_in_words

NAMES = tuple(f"A{i}" for i in range(1, 7))
TURNED = CommonMotion(
    "accelerometer", "axes", "separated", (0.0, -12.0 * ARCSEC, 0.0),
    tuple(tuple(float(x) for x in row) for row in np.eye(3) * (0.5 * ARCSEC) ** 2), 1e-9, NAMES, (),
)  # fmt: skip


def said(motion: CommonMotion) -> list[str]:
    return [line.text for line in motions_in_words([motion], 2.0)]


def test_a_turn_names_size_axis_and_cause() -> None:
    assert said(TURNED) == [
        "The whole block turned by 12.0\u00a0±\u00a01.0\u202farcsec about −Y since the reference: "
        "it was mounted differently, or the stand has turned. The sensors are judged without this effect."
    ]


def test_a_turn_that_noise_explains_is_not_mentioned() -> None:
    still = CommonMotion(**{**vars(TURNED), "p_value": 0.2})
    assert said(still) == []
    assert said(CommonMotion(**{**vars(still), "left_out": ("A2", "A5")})) == []


def test_sensors_that_did_not_turn_with_the_block_are_named() -> None:
    text = said(CommonMotion(**{**vars(TURNED), "left_out": ("A2", "A5")}))[0]
    assert text.endswith("In addition, the input axes of A2 and A5 changed.")


def test_a_common_factor_is_gravity_or_stand() -> None:
    scaled = CommonMotion("accelerometer", "scales", "separated", (35e-6,), ((4e-12,),), 1e-9, NAMES, ("A3",))
    assert said(scaled) == [
        "All scale factors changed together by +35.0\u00a0±\u00a04.0\u202fppm since the reference; "
        "cause: gravity or the stand's elevation. The sensors are judged without this effect. "
        "In addition, the scale factor of A3 changed."
    ]


def test_too_few_sensors_and_disagreement_are_said() -> None:
    few = CommonMotion("accelerometer", "axes", "too-few-sensors", (), (), None, NAMES[:3], ())
    assert said(few)[0].startswith("3 sensors are too few to separate a turn of the whole block from a change of one")
    unclear = CommonMotion("gyroscope", "scales", "unclear", (), (), None, NAMES, ())
    assert said(unclear)[0].endswith("which of them changed is not known: every sensor is judged by its whole change.")
