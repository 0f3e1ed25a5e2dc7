"""Files of sessions on a turntable, as bytes, for the tests of the service."""

import json

import numpy as np

from estimator.alignment.simulate import (
    Imperfections,
    Programme,
    Truth,
    simulate_alignment,
    simulate_rate_table,
    triads,
)
from estimator.results import ARCSEC
from estimator.session import CalibrationSession, Site
from estimator.writing import session_document

SITE = Site(latitude=np.radians(40.0))
MICRO_G = 9.80665e-6
MOUNTING = (4 * ARCSEC, 8 * ARCSEC)
NOISE = Imperfections(wobble=0.3 * ARCSEC, table=0.3 * ARCSEC)


def _bytes(session: CalibrationSession, month: int) -> bytes:
    return json.dumps(session_document(session) | {"started_at": f"2026-{month:02d}-01T09:00:00Z"}).encode()


def alignment_bytes(
    *, seed: int = 1, month: int = 3, unit: str = "RA-1", x_moved: float = 0.0, mounting: tuple[float, float] = MOUNTING
) -> bytes:
    """An alignment; ``x_moved`` is ∇_x in µg."""
    truth = Truth(accelerometer_bias=np.array([x_moved * MICRO_G, 0.0, 0.0]), mounting=mounting)
    programme = Programme(dwell=200.0, row=1.0)
    rng = np.random.default_rng(seed)
    session, _ = simulate_alignment(triads(), SITE, programme, truth, rng, imperfections=NOISE, unit=unit)
    return _bytes(session, month)


def rate_table_bytes(*, seed: int = 1, month: int = 3, unit: str = "RA-1") -> bytes:
    """A rate-table session of twelve whole turns."""
    runs = ((0.5, 80.0), (-0.5, 80.0))
    rng = np.random.default_rng(seed)
    session = simulate_rate_table(triads(), SITE, runs, Truth(mounting=MOUNTING), rng, row=0.5, unit=unit)
    return _bytes(session, month)
