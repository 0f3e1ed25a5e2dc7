"""Files of sessions on a turntable, as bytes, for the tests of the service."""

import json

import numpy as np

from estimator.alignment.simulate import (
    Imperfections,
    Truth,
    TurntableProgramme,
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
    *,
    seed: int = 1,
    month: int = 3,
    unit: str = "RA-1",
    x_moved: float = 0.0,
    mounting: tuple[float, float] = MOUNTING,
    a2_stands: tuple[float, float] | None = None,
) -> bytes:
    """An alignment; ``x_moved`` is ∇_x in µg, ``a2_stands`` where A2 stands from the turn axis, m."""
    places = None if a2_stands is None else np.zeros((6, 3))
    if places is not None:
        places[1, :2] = a2_stands
    truth = Truth(accelerometer_bias=np.array([x_moved * MICRO_G, 0.0, 0.0]), mounting=mounting, positions=places)
    programme = TurntableProgramme(dwell=200.0, row=1.0, ramp=0.0 if places is None else 2.0)
    rng = np.random.default_rng(seed)
    session, _ = simulate_alignment(triads(), SITE, programme, truth, rng, imperfections=NOISE, unit=unit)
    return _bytes(session, month)


def rate_table_bytes(*, seed: int = 1, month: int = 3, unit: str = "RA-1") -> bytes:
    """A rate-table session of twelve whole turns."""
    runs = ((0.5, 80.0), (-0.5, 80.0))
    rng = np.random.default_rng(seed)
    session = simulate_rate_table(triads(), SITE, runs, Truth(mounting=MOUNTING), rng, row=0.5, unit=unit)
    return _bytes(session, month)
