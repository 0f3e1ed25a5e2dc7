"""Histories of sessions measured at one temperature, and at several."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from service.outlook.rules.histories import histories
from service.outlook.store import ChangeRow, ReferenceRow

START = datetime(2024, 1, 10, tzinfo=UTC)
REFERENCE, COMMON = -0.12, 3e-5
"""V per m/s² of a sensor that is read with its sign reversed, and what all scale factors did together, relative."""
WHOLE = np.array([1e-5, -2e-5, 4e-5, 3e-5, -1e-5])


def change(temperatures: tuple[float, ...]) -> np.ndarray:
    """Change of a scale factor that is judged without the common part."""
    rows = [
        ChangeRow(
            at=START + timedelta(days=60 * (k + 1)), block="accelerometer", programme="two-axis-stand", sensor="A1",
            kind="accelerometer", parameter="scale", tolerance=1e-4, change=[whole - COMMON], own=[2e-6], origin=[1e-6],
            dof=None, temperature=warm, value=REFERENCE * (1 + whole), reference=REFERENCE, u=6e-7,
        )
        for k, (whole, warm) in enumerate(zip(WHOLE, temperatures, strict=True))
    ]  # fmt: skip
    reference = ReferenceRow(START, "accelerometer", "two-axis-stand", 20.0, u={("A1", "scale"): 4.8e-7})
    (track,) = histories(rows, [reference]).tracks
    return np.hstack([track.change, track.sigma])


def test_at_one_temperature_it_is_what_was_judged() -> None:
    seen = change((20.0, 20.4, 19.7, 20.1, 20.0))
    assert seen[1:, 0] == pytest.approx(WHOLE - COMMON)
    assert seen[:, 1] == pytest.approx([1e-6] + [2e-6] * 5)


def test_at_several_it_is_what_was_measured() -> None:
    seen = change((14.0, 26.0, 18.0, 30.0, 22.0))
    assert seen[0, 0] == 0.0
    assert seen[1:, 0] == pytest.approx(WHOLE)
    assert seen[:, 1] == pytest.approx([4e-6] + [5e-6] * 5)
