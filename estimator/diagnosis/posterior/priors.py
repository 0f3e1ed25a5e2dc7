"""Every constant of the model: a prior with its physical reason, or a decision on the posterior."""

from collections.abc import Sequence

import numpy as np

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.session import ACCELEROMETER, Array

SIZES = 2e-7 * STANDARD_GRAVITY * 4.0 ** np.arange(10)
"""m/s²: sizes of an effect, the largest that it does to a reading, all equally likely (log-uniform): from 0.2 µg, below
which no accelerometer resolves, to 50 mg, beyond which a reading is grossly wrong and is set aside before."""

RATE = 1e-2
"""(rad/s)/(m/s²): a gyro's size for one of an accelerometer: from 2e-8 rad/s, 0.004 °/h, to 0.3 °/s."""


def units(kinds: Sequence[str], norm: Array) -> Array:
    """(m,) what one m/s² of `SIZES` is for sensors of ``kinds`` whose applied vector has the length ``norm`` (m,)."""
    share = np.broadcast_to(norm, (len(kinds),)) / STANDARD_GRAVITY
    return np.where([kind == ACCELEROMETER for kind in kinds], share, RATE)


MISSTATED = 0.03
"""Prior odds that the stated standard errors of a kind of sensor are off by one factor."""

TAILS = 0.03
"""Prior odds that errors have tails, all laws together: readings are means of many samples, which are nearly normal."""

SOMETHING = 3.0
"""Prior odds that some cause of the catalogue acts at all, shared evenly among them: at most 1 % of sound sessions may
get a name."""

EACH_CAUSE = SOMETHING / 44
"""Prior odds of one cause of the catalogue, all its places and shapes together."""

IN_PART = 0.03
"""Share of a cause's odds on that it acted in part of the history, so that its sensor changed since then by any amount:
else every change of a sensor could pass for some effect that hardly shows."""

FURTHER = float(np.log(0.03))
"""ln of the odds that something else happened in the same session, over those that anything did: misfortunes are
independent, and two of them are rarer than one."""

ONE_WITHIN = 0.6
"""Standard deviation of the amplitude of a single clipped reading, one at the limit that is tried: the true limit lies
anywhere between there and twice as deep."""

OWN_COURSE = 0.05
"""Prior odds that some sensor has a course that nothing describes: the catalogue holds what usually happens."""

COMMON_COURSE = 0.03
"""Prior odds that the applied vector has one."""

NOISY = 0.05
"""Prior odds that some sensor is noisier than stated: as often as one has a course."""

UNLIKE = 0.3
"""Prior odds that a sensor whose noise is not stated is noisier than usual of its kind."""

SHARED = 0.02
"""Prior odds that several sensors share one course."""

WANDERING = 1e-4
"""Prior odds that all zeros of a kind of sensor wander, each by itself: a room warms all of them far more often."""

SPREADS = 2.0 ** np.arange(-2, 8)
"""Standard errors by which a zero wanders: from a quarter, which hundreds of readings together may tell."""

MOVED = 0.01
"""Prior odds that some sensor's parameters changed since the history in a way that no drift describes."""

NOISE_RATIOS = 2.0 ** np.arange(-1, 11)
"""Variance of a noisy sensor beyond the stated one, in units of it: up to thirty times the standard error, beyond which
readings are no noise."""

CREDIBLE = 0.995
"""Probability that a name and its alternatives hold together."""

MOST = 10
"""Terms in one session: more is a session that nobody should use, and ends the search."""
