"""Causes that change how the block is held, or how the record says that it was held. One plain function each."""

from dataclasses import replace

import numpy as np

from tests.blind.pose import Pose
from tests.blind.world import Effect, Session


def beta_eccentricity(session: Session, effect: Effect, pose: Pose) -> Pose:
    k1, k2 = effect.amplitude
    beta = session.schedule.beta
    return pose.moved(beta=k1 * np.sin(beta) + k2 * np.cos(beta))


def beta_second_harmonic(session: Session, effect: Effect, pose: Pose) -> Pose:
    k1, k2 = effect.amplitude
    beta = session.schedule.beta
    return pose.moved(beta=k1 * np.sin(2 * beta) + k2 * np.cos(2 * beta))


def beta_scale(session: Session, effect: Effect, pose: Pose) -> Pose:
    beta = session.schedule.beta
    return pose.moved(beta=effect.k * (beta - beta.mean()))


def axis_wobble(session: Session, effect: Effect, pose: Pose) -> Pose:
    k1, k2 = effect.amplitude
    beta = session.schedule.beta
    raised = k1 * np.sin(beta) + k2 * np.cos(beta)
    return pose.moved(alpha=raised, chi=raised)


def levelling_y(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(theta_y=effect.k)


def alpha_shift(session: Session, effect: Effect, pose: Pose) -> Pose:
    raised = effect.k * pose.flipped
    return pose.moved(alpha=raised, chi=raised)


def flip_misalignment(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(turn=pose.flipped[:, None] * np.array(effect.amplitude))


def stand_drift(session: Session, effect: Effect, pose: Pose) -> Pose:
    time = session.schedule.time
    raised = effect.k * (time - time.mean())
    return pose.moved(alpha=raised, chi=raised)


def positions_swapped(session: Session, effect: Effect, pose: Pose) -> Pose:
    rows = np.arange(session.schedule.rows)
    i, k = (int(j) for j in effect.shape)
    rows[[i, k]] = k, i
    return replace(pose, beta=pose.beta[rows], flipped=pose.flipped[rows])


def runs_swapped(session: Session, effect: Effect, pose: Pose) -> Pose:
    return replace(pose, flipped=~pose.flipped)


def beta_reversed(session: Session, effect: Effect, pose: Pose) -> Pose:
    return replace(pose, beta=pose.beta - 2 * session.schedule.beta)


def alpha_entry(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(alpha=effect.k)


def gravity_entry(session: Session, effect: Effect, pose: Pose) -> Pose:
    return replace(pose, gravity_factor=pose.gravity_factor * (1 + effect.k))


def remount_rotation(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(turn=np.array(effect.amplitude))


def latitude_entry(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(chi=effect.k)


def meridian_error(session: Session, effect: Effect, pose: Pose) -> Pose:
    return pose.moved(meridian=effect.k)


POSE = {
    "beta-eccentricity": beta_eccentricity,
    "beta-second-harmonic": beta_second_harmonic,
    "beta-scale": beta_scale,
    "axis-wobble": axis_wobble,
    "levelling-y": levelling_y,
    "alpha-shift": alpha_shift,
    "flip-misalignment": flip_misalignment,
    "stand-drift": stand_drift,
    "positions-swapped": positions_swapped,
    "runs-swapped": runs_swapped,
    "beta-reversed": beta_reversed,
    "alpha-entry": alpha_entry,
    "gravity-entry": gravity_entry,
    "remount-rotation": remount_rotation,
    "latitude-entry": latitude_entry,
    "meridian-error": meridian_error,
}
