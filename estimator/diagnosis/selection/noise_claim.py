"""The stated noise is a claim: where the readings of sensors scatter otherwise, its scale is taken as unknown.

Theory
------
With E the energy of a sensor's residuals in their stated sigmas and ν its degrees of freedom, E is χ² where the stated
noise is right and nothing else acts. Where E is too large for most sensors of a kind, or too small for any, which no
effect can make it, causes are sought by F instead of χ² on all of the kind: their strength is then measured in the
scatter that the readings show, whatever the file says. What the causes leave decides. Scatter as stated: the noise was
right, and is believed again. Scatter as far off as before: the stated errors were wrong, by the factor √(E/ν). Where
that is so of some sensors only, causes are sought a last time with the others' noise as stated. Where rows repeat a
position, their differences are *pure error*, free of any model: where they agree with the stated noise, it stands.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtr

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import unstated_noise
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.excess_noise import sensor_scatter
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.start import restart_from, with_earlier_scatter, with_residual_scatter
from estimator.diagnosis.signatures.noise import NoiseClaim
from estimator.session import Array
from estimator.significance import p_value

DOUBTFUL = 1e-3
"""p-value of all residuals of a kind together below which its stated noise is in doubt."""

SEEN = 1e-3
"""p-value by which half of its sensors must show more, each for itself: one noisy sensor is no wrong claim, though
what they share of a row's β error lets it be seen faintly in others."""

QUIET = 1e-4
"""p-value, over the sensors of a kind, of one that scatters less than stated: no effect makes a sensor quieter, so that
one sensor is evidence enough."""

MORE = 1
"""The sense in which an effect makes readings scatter, where one sensor is no evidence about the claim."""

AGREES = 0.01
"""p-value above which differences of repeated rows agree with the stated noise."""

LINEAR = 1e-4
"""rad; a fit by other weights that moves axes further has met an effect, such as a turned run, that is not linear."""

SMALLEST = 1e-8
"""Variance over the stated one below which none is distinguished: readings simulated without noise leave rounding."""

BEYOND_NOISE = 30.0
"""Times the stated standard errors from which on scatter is no misjudged noise: stated ones were seen to be four to
twenty times too small."""

ENOUGH = 20
"""Degrees of freedom of a sensor from which on its own readings tell its factor to a sixth."""

FEWEST = 6
"""Degrees of freedom of repeats, or of a kind's residuals, from which on they tell a scale."""


@dataclass(frozen=True)
class ClaimScatter:
    """Energy, in stated sigmas, and its degrees of freedom."""

    energy: float
    freedom: float

    @property
    def tails(self) -> tuple[float, float]:
        """Chance of less, and of more, under the stated noise."""
        return float(chdtr(self.freedom, self.energy)), float(p_value(self.energy, self.freedom))

    def is_alike(self, others: "ClaimScatter", side: int) -> bool:
        """Whether this scatter may be off as that of ``others`` is: not in the other sense, nor plainly as stated."""
        here = replace(self, energy=self.energy * others.freedom / max(others.energy, SMALLEST * others.freedom))
        as_stated = min(self.tails) > SEEN > min(here.tails)
        return self.tails[1 - side] > SEEN and not as_stated


def doubted(state: SearchState) -> tuple[NoiseClaim, ...]:
    """Sensors that scatter otherwise than stated, most of a kind or less than they should, after all that was found."""
    unstated = unstated_noise(state.baseline.session)
    claims: list[NoiseClaim] = []
    for kind in dict.fromkeys(state.baseline.setting.kinds):
        of_kind = np.array([k == kind for k in state.baseline.setting.kinds])
        if of_kind.sum() > 1 and not unstated[of_kind].any():
            claims.extend(_claims(state, kind, np.flatnonzero(of_kind)))
    return tuple(claims)


def is_one_sensor(state: SearchState) -> bool:
    """Whether nothing is left to be claimed once the noisiest sensor has a noise of its own: it pulls what all share of
    a row to its readings, and the others then scatter too.
    """
    energy, freedom = sensor_scatter(state)
    unstated = state.baseline.unstated.copy()
    noisiest = int(np.argmax(energy / np.maximum(freedom, 1.0)))
    unstated[noisiest] = True
    alone = refitted(with_residual_scatter(replace(state.baseline, unstated=unstated), [[noisiest]]))
    return not doubted(replace(state, residuals=WhitenedResiduals.of(replace(alone, unstated=state.baseline.unstated))))


def _claims(state: SearchState, kind: str, of_kind: Array) -> Iterator[NoiseClaim]:
    """The claims about the sensors (k,) int of one kind; at most one for each side, less noise or more."""
    each = scatter_of(state, of_kind)
    whole = together(each)
    for side, least in enumerate((QUIET / len(each), SEEN)):
        seen = [s for s in each if s.tails[side] < least]
        most = 2 * sum(s.tails[side] < SEEN for s in each) >= len(each) and whole.tails[side] < DOUBTFUL
        quiet = side != MORE and (bool(seen) or whole.tails[side] < QUIET)
        if not most and not quiet:
            continue
        chosen = together([s for s in each if s.tails[side] < SEEN] or each)
        alike = [s.is_alike(chosen, side) for s in each]
        claimed, sensors = together(s for s, yes in zip(each, alike, strict=True) if yes), of_kind[alike]
        if claimed.freedom >= FEWEST and not is_credible(replace(state.baseline, variance=state.stated), sensors):
            ratio = max(claimed.energy / claimed.freedom, SMALLEST)
            yield NoiseClaim(kind, tuple(sensors.tolist()), ratio, claimed.freedom)


def together(each: Iterable[ClaimScatter]) -> ClaimScatter:
    """The scatter of several sensors."""
    parts = tuple(each)
    return ClaimScatter(sum(s.energy for s in parts), sum(s.freedom for s in parts))


def scatter_of(state: SearchState, of_kind: Array) -> list[ClaimScatter]:
    """The scatter that a search leaves of each of some sensors (k,) int, dimensionless, in its stated errors."""
    energy, freedom = sensor_scatter(state)
    scale = np.median(state.baseline.variance / state.stated, axis=0)
    return [ClaimScatter(float(energy[i] * scale[i]), float(freedom[i])) for i in of_kind]


def is_credible(baseline: Baseline, of_kind: Array) -> bool:
    """Whether rows at one position repeat as closely as the stated noise allows; ``of_kind`` (k,) int, sensors."""
    pure = pure_error(baseline, of_kind)
    return pure.freedom >= FEWEST and min(pure.tails) > AGREES


def pure_error(baseline: Baseline, of_kind: Array) -> ClaimScatter:
    """Scatter of rows at the same β in the same run about their mean; ``of_kind`` (k,) int, sensors.

    In standard errors of a row, its β error among them.
    """
    setting = baseline.setting
    if setting.beta is None or setting.flipped is None:
        return ClaimScatter(0.0, 0.0)
    whitened = WhitenedResiduals.of(baseline).whiten(baseline.residual[..., None]).reshape(setting.rows, -1)[:, of_kind]
    place = np.stack([np.round(np.mod(setting.beta, 2 * np.pi), 9), setting.flipped], axis=-1)
    _, group = np.unique(place, axis=0, return_inverse=True)
    count = np.bincount(group.ravel())
    mean = np.stack([np.bincount(group.ravel(), weights=column) / count for column in whitened.T], axis=-1)
    deviations = whitened - mean[group.ravel()]
    return ClaimScatter(float((deviations**2).sum()), float((count - 1).sum() * len(of_kind)))


def of_whole_kinds(state: SearchState, claims: Iterable[NoiseClaim]) -> tuple[NoiseClaim, ...]:
    """The claims, every other sensor of their kinds in one of its own: an effect may hide that it is off too.

    That half of a kind or more scatters less is a claim of the whole: the others only seem not to, by what acts on
    them.
    """
    wider, kinds = [], state.baseline.setting.kinds
    for claim in claims:
        if is_quieter(state, [claim]):
            wider.append(of_its_kind(state, claim))
            continue
        rest = [i for i, k in enumerate(kinds) if k == claim.kind and i not in claim.sensors]
        others = [NoiseClaim(claim.kind, (i,), 1.0, 0.0) for i in rest]
        wider += [claim, *others]
    return tuple(wider)


def of_its_kind(state: SearchState, claim: NoiseClaim) -> NoiseClaim:
    """The claim, extended to all sensors of its kind."""
    whole = tuple(i for i, k in enumerate(state.baseline.setting.kinds) if k == claim.kind)
    return replace(claim, sensors=whole, freedom=claim.freedom * len(whole) / len(claim.sensors))


def with_quieter_kinds_whole(state: SearchState, claims: tuple[NoiseClaim, ...]) -> tuple[NoiseClaim, ...]:
    """The claims; of a kind of which nothing else is claimed than that it scatters less, its whole is claimed.

    What is claimed of one kind is no evidence about another: that one is believed again, though this is not.
    """
    alone = {claim.kind for claim in claims if is_quieter(state, [c for c in claims if c.kind == claim.kind])}
    return tuple(of_its_kind(state, claim) if claim.kind in alone else claim for claim in claims)


def is_quieter(state: SearchState, claims: Iterable[NoiseClaim]) -> bool:
    """Whether every claim is of less scatter than stated, for at least half of its kind."""
    kinds = state.baseline.setting.kinds
    return all(c.ratio < 1 and 2 * len(c.sensors) >= kinds.count(c.kind) for c in claims)


def sensors_of(claims: Iterable[NoiseClaim]) -> set[int]:
    """All sensors that the claims concern."""
    return {i for claim in claims for i in claim.sensors}


def without_names_in_no_noise(state: SearchState) -> SearchState:
    """The state without names of sensors, or common to all, that scatter as no noise does: it points to no cause."""
    lost = {i for claim in state.noise_claims if claim.ratio > BEYOND_NOISE**2 for i in claim.sensors}
    detections = tuple(f for f in state.detections if not lost or (f.best.sensors and lost.isdisjoint(f.best.sensors)))
    return replace(state, detections=detections)


def groups_of(claim: NoiseClaim) -> list[tuple[int, ...]]:
    """Sensors whose factor is fitted as one: each by itself where its own readings tell it."""
    if claim.freedom < ENOUGH * len(claim.sensors):
        return [claim.sensors]
    return [(i,) for i in claim.sensors]


def with_unknown_scale(
    start: SearchState, claims: tuple[NoiseClaim, ...], detections: tuple[Detection, ...] = ()
) -> SearchState:
    """The search begun anew with the noise of some sensors known up to a factor, which each one's own readings tell.

    The others of its kind tell nothing: what all show, such as a warm-up of the whole block, would pass for noise.
    ``detections`` were made before, and are no noise.
    """
    baseline = start.baseline
    sensors = sorted(sensors_of(claims))
    unstated = baseline.unstated.copy()
    expected = np.zeros(len(unstated)) if baseline.expected_ratio is None else baseline.expected_ratio.copy()
    unstated[sensors], expected[sensors] = True, 0.0
    off = [group for claim in claims if claim.freedom > 0 for group in groups_of(claim)]
    named = np.concatenate([f.best.shape.columns for f in detections], axis=-1) if detections else None
    scaled = with_residual_scatter(baseline, off, named)
    changed = replace(scaled, unstated=unstated, expected_ratio=expected)
    again = refitted(changed)
    moved = np.abs(again.parameters.axis - baseline.parameters.axis).max()
    earlier = with_earlier_scatter(start, sensors)
    return replace(restart_from(earlier, again if moved < LINEAR else changed), noise_claims=claims)
