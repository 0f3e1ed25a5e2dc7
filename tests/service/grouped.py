"""Sessions that share an effect too small for one of them, as bytes: a cubic term of A2, about two standard errors
in each."""

import json

import numpy as np

from tests.service.made_sessions import session_bytes

CUBIC = 6.5e-8
"""(m/s²)⁻² of A2: some two standard errors of a session, seven of twelve. Counted, not derived: a session that shows
it by itself fails the test that says none does."""
SCALE = 0.12


def cubic_session(number: int, *, unit: str = "BA-017", cubic: float = CUBIC) -> bytes:
    """One of several sessions, a month after the one before, of three sensors."""
    year, month = 2023 + number // 12, number % 12 + 1
    document = json.loads(session_bytes(seed=100 + number, unit=unit, m=3))
    readings = np.array(document["table"]["A2"])
    document["table"]["A2"] = (readings + SCALE * cubic * (readings / SCALE) ** 3).tolist()
    return json.dumps(document | {"started_at": f"{year}-{month:02d}-01T09:00:00Z", "unit_type": "three"}).encode()


GROUP = tuple(cubic_session(number) for number in range(12))
"""Twelve of one unit, oldest first."""

WAVE = 2e-4
"""m/s² of sin(3β + 0.5) on A2, which no cause has: plain in four sessions."""


def wavy_session(number: int, size: float = WAVE) -> bytes:
    """One of several sessions, a month after the one before."""
    document = json.loads(session_bytes(seed=300 + number, m=3))
    wave = size * np.sin(3 * np.deg2rad(document["table"]["beta_deg"]) + 0.5)
    document["table"]["A2"] = (np.array(document["table"]["A2"]) + SCALE * wave).tolist()
    return json.dumps(document | {"started_at": f"2023-{number + 1:02d}-01T09:00:00Z", "unit_type": "three"}).encode()


WAVY = tuple(wavy_session(number) for number in range(4))
"""Four of one unit, oldest first."""
