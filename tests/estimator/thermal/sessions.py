"""Sessions and rows of the thermal programme, for its tests."""

from dataclasses import replace

import numpy as np

from estimator import read_session
from estimator.json_object import Json
from estimator.session import Array, CalibrationSession
from estimator.thermal.model import State, ThermalRows
from tests.estimator.thermal.physics import EARTH, cone, unit


def session_of(document: Json) -> CalibrationSession:
    return read_session(document)


def rows_and_state(
    *, gyros: int = 0, stated: bool = False, settings: int = 14, seed: int = 1
) -> tuple[ThermalRows, State]:
    """Twice as many rows as settings, of four accelerometers and some gyros; all unknowns far from nothing."""
    rng = np.random.default_rng(seed)
    m, R = 4 + gyros, 2 * settings
    gyro = np.arange(m) >= 4
    x = rng.uniform(-1, 1, R)
    nominal = np.concatenate([cone(4), cone(3)[:gyros]])
    up = unit(rng.standard_normal((settings, 3)))
    scale = np.column_stack([1 + 0.1 * rng.standard_normal(m), 0.1 * rng.standard_normal(m)])
    state = State(
        scale=np.where(gyro[:, None], [1.0, 0.0], scale),
        bias=0.1 * rng.standard_normal((m, 3)),
        quadratic=np.where(gyro, 0.0, 0.1 * rng.standard_normal(m)),
        axes=unit(nominal + 0.1 * rng.standard_normal((m, 3))),
        directions=unit(up + 0.02 * rng.standard_normal((settings, 3))),
        rates=EARTH * rng.standard_normal((settings, 3)),
    )
    rows = ThermalRows(
        y=np.zeros((R, m)),
        sigma=np.where(gyro, 2e-5, 1e-2) * rng.uniform(0.5, 2, (R, m)),
        setting=np.repeat(np.arange(settings), 2),
        directions=up if stated else np.zeros_like(up),
        prior=np.linspace(50.0, 100.0, settings) if stated else np.zeros(settings),
        nominal_axes=nominal,
        gyro=gyro,
        scale_basis=np.column_stack([np.ones(R), x]),
        bias_basis=np.column_stack([np.ones(R), x, x**2]),
    )
    return replace(rows, y=model_y(rows, state) + rows.sigma * rng.standard_normal((R, m))), state


def model_y(rows: ThermalRows, state: State) -> Array:
    """y = G·(s + β + γ·s²), sensor by sensor and row by row."""
    y = np.zeros_like(rows.y)
    for r, g in enumerate(rows.setting):
        for i, is_gyro in enumerate(rows.gyro):
            s = float((state.rates if is_gyro else state.directions)[g] @ state.axes[i])
            gain, bias = rows.scale_basis[r] @ state.scale[i], rows.bias_basis[r] @ state.bias[i]
            y[r, i] = gain * (s + bias + state.quadratic[i] * s**2)
    return y
