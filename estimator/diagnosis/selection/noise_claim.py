"""The stated noise is a claim: where the readings of most sensors scatter otherwise, its scale is taken as unknown.

Theory
------
With E the energy of a sensor's residuals in their stated sigmas and ν its degrees of freedom, E is χ² where the stated
noise is right and nothing else acts. Where E is too large, or too small, for most sensors of a kind, causes are sought
by F instead of χ²: their strength is then measured in the scatter that the readings show, whatever the file says. What
the causes leave decides. Scatter as stated: the noise was right, and is believed again. Scatter as far off as before:
the stated errors were wrong, by the factor √(E/ν). Where rows repeat a position, their differences are *pure error*,
free of any model: where they agree with the stated noise, it stands.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtr, chdtrc

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import unstated_noise
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.excess_noise import sensor_scatter
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.selection.start import begun_with
from estimator.diagnosis.signatures.noise import NoiseClaim
from estimator.session import Array

DOUBTFUL = 1e-3
"""p-value of all residuals of a kind together below which its stated noise is in doubt."""

SEEN = 1e-3
"""p-value by which half of its sensors must show the same, each for itself: one noisy sensor is no wrong claim, though
what they share of a row's β error lets it be seen faintly in others."""

AGREES = 0.01
"""p-value above which differences of repeated rows agree with the stated noise."""

LINEAR = 1e-4
"""rad; a fit by other weights that moves axes further has met an effect, such as a turned run, that is not linear."""

SMALLEST = 1e-8
"""Variance over the stated one below which none is told apart: readings simulated without noise leave rounding."""

FEWEST = 6
"""Degrees of freedom of repeats, or of a kind's residuals, from which on they tell a scale."""


@dataclass(frozen=True)
class Scatter:
    """Energy, in stated sigmas, and its degrees of freedom."""

    energy: float
    freedom: float

    @property
    def tails(self) -> tuple[float, float]:
        """Chance of less, and of more, under the stated noise."""
        return float(chdtr(self.freedom, self.energy)), float(chdtrc(self.freedom, self.energy))


def doubted(state: SearchState) -> tuple[NoiseClaim, ...]:
    """Kinds of sensor that scatter otherwise than stated, most sensors in the same sense, after all that was found."""
    found = []
    for kind in dict.fromkeys(state.baseline.setting.kinds):
        own = np.array([k == kind for k in state.baseline.setting.kinds])
        each = scatter_of(state, own)
        if len(each) < 2 or unstated_noise(state.baseline.session)[own].any():
            continue
        whole = Scatter(sum(s.energy for s in each), sum(s.freedom for s in each))
        side = int(np.argmin(whole.tails))
        agreeing = sum(s.tails[side] < SEEN for s in each)
        if whole.freedom < FEWEST or whole.tails[side] > DOUBTFUL or 2 * agreeing < len(each):
            continue
        if not stands(replace(state.baseline, variance=state.stated), own):
            found.append(NoiseClaim(kind, max(whole.energy / whole.freedom, SMALLEST), whole.freedom))
    return tuple(found)


def scatter_of(state: SearchState, own: Array) -> list[Scatter]:
    """What a search leaves of each of some sensors (m,) bool, dimensionless, in its stated errors."""
    energy, freedom = sensor_scatter(state)
    scale = np.median(state.baseline.variance / state.stated, axis=0)
    return [Scatter(float(energy[i] * scale[i]), float(freedom[i])) for i in np.flatnonzero(own)]


def stands(baseline: Baseline, own: Array) -> bool:
    """Whether rows of one position repeat as the stated noise says; ``own`` (m,) bool, dimensionless."""
    pure = pure_error(baseline, own)
    return pure.freedom >= FEWEST and min(pure.tails) > AGREES


def pure_error(baseline: Baseline, own: Array) -> Scatter:
    """Scatter of rows at the same β in the same run about their mean; ``own`` (m,) bool, dimensionless.

    In standard errors of a row, its β error among them.
    """
    setting = baseline.setting
    if setting.beta is None or setting.flipped is None:
        return Scatter(0.0, 0.0)
    whitened = WhitenedResiduals.of(baseline).whiten(baseline.residual[..., None]).reshape(setting.rows, -1)[:, own]
    place = np.stack([np.round(np.mod(setting.beta, 2 * np.pi), 9), setting.flipped], axis=-1)
    _, group = np.unique(place, axis=0, return_inverse=True)
    count = np.bincount(group.ravel())
    mean = np.stack([np.bincount(group.ravel(), weights=column) / count for column in whitened.T], axis=-1)
    left = whitened - mean[group.ravel()]
    return Scatter(float((left**2).sum()), float((count - 1).sum() * own.sum()))


def with_unknown_scale(start: SearchState, claims: tuple[NoiseClaim, ...]) -> SearchState:
    """The search begun anew with the noise of some kinds known up to a factor, which each sensor's own readings tell.

    The others of its kind tell nothing: what all show, such as a warm-up of the whole block, would pass for noise.
    """
    baseline = start.baseline
    variance, unstated = baseline.variance.copy(), baseline.unstated.copy()
    expected = np.zeros(len(unstated)) if baseline.expected_ratio is None else baseline.expected_ratio.copy()
    for claim in claims:
        own = np.array([kind == claim.kind for kind in baseline.setting.kinds])
        variance[:, own] *= claim.ratio
        unstated[own], expected[own] = True, 0.0
    changed = replace(baseline, variance=variance, unstated=unstated, expected_ratio=expected)
    again = refitted(changed)
    moved = np.abs(again.parameters.axis - baseline.parameters.axis).max()
    return replace(begun_with(start, again if moved < LINEAR else changed), noise_claims=claims)
