"""Structure that no cause of the catalogue expresses: an honest diagnosis says that it is there and names nothing.

Arguments and what is returned are those of `effects_sensor`; φ is drawn.
"""

import numpy as np

from tests.blind.pose import Pose
from tests.blind.world import Array, Effect, Session


def third_harmonic(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·sin(3β + φ)."""
    return effect.k * np.sin(3 * session.schedule.beta + effect.shape[0])


def fifth_harmonic(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·sin(5β + φ)."""
    return effect.k * np.sin(5 * session.schedule.beta + effect.shape[0])


def periodic_in_time(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: three or more periods in the time of the session."""
    time = session.schedule.time
    periods = 3 + effect.shape[0] / 2
    return effect.k * np.sin(2 * np.pi * periods * time / time[-1] + effect.shape[0])


def temperature_square_wave(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: ±k by the temperature, in 2.3 waves over its range."""
    temperature = session.schedule.temperature
    width = np.ptp(temperature) / 4.6
    return effect.k * np.sign(np.sin(2 * np.pi * (temperature - temperature.min()) / width + 0.3))


def random_walk(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k times a walk of unit steps."""
    steps = np.random.default_rng(int(1e6 * effect.shape[0])).standard_normal(len(a))
    return effect.k * np.cumsum(steps)


def turning_scale(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·a·sin(2β + φ)."""
    return effect.k * a * np.sin(2 * session.schedule.beta + effect.shape[0])


def every_other_row(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: +k, −k, +k, …."""
    return effect.k * (-1.0) ** np.arange(len(a))


def kink(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·(a beyond a corner)."""
    corner = a.min() + np.ptp(a) * (0.55 + 0.05 * effect.shape[0])
    return effect.k * np.maximum(0.0, a - corner)


def temperature_hump(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
    """(R,) m/s² or rad/s: k·cos of one and a half periods over the range of the temperature."""
    temperature = session.schedule.temperature
    return effect.k * np.cos(3 * np.pi * (temperature - temperature.min()) / np.ptp(temperature))


OUTSIDE_INPUT = {
    "third-harmonic": third_harmonic,
    "fifth-harmonic": fifth_harmonic,
    "periodic-in-time": periodic_in_time,
    "temperature-square-wave": temperature_square_wave,
    "random-walk": random_walk,
    "turning-scale": turning_scale,
    "every-other-row": every_other_row,
    "kink": kink,
    "temperature-hump": temperature_hump,
}


def encoder_third_harmonic(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(beta=effect.k * np.sin(3 * session.schedule.beta + effect.shape[0]))


def bearing_second_harmonic(session: Session, effect: Effect, pose: Pose) -> Pose:
    raised = effect.k * np.sin(2 * session.schedule.beta + effect.shape[0])
    return pose.moved(alpha=raised, chi=raised)


def swaying_stand(session: Session, effect: Effect, pose: Pose) -> Pose:
    rows = np.arange(session.schedule.rows)
    return pose.moved(theta_y=effect.k * np.sin(2 * np.pi * rows / 5.3 + effect.shape[0]))


OUTSIDE_POSE = {
    "encoder-third-harmonic": encoder_third_harmonic,
    "bearing-second-harmonic": bearing_second_harmonic,
    "swaying-stand": swaying_stand,
}

OUTSIDE_NEEDS = {
    "periodic-in-time": frozenset({"time"}),
    "temperature-square-wave": frozenset({"temperature"}),
    "temperature-hump": frozenset({"temperature"}),
    "third-harmonic": frozenset({"both runs"}),
    "fifth-harmonic": frozenset({"both runs"}),
}
