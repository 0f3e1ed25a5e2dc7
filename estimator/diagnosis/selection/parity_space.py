"""The search in parity space: no applied vector is believed, so that no error of stand, fixture or reference shows."""

from dataclasses import replace

import numpy as np

from estimator.calibration.noise import typical, with_the_others
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.selection.start import begun_with
from estimator.diagnosis.signatures.applied_course import SIZE, components

ROUNDS = 8
"""Steps of the noise in parity space: each halves what is left at least."""


def in_parity_space(start: SearchState, *, size: bool) -> SearchState:
    """The search begun where no applied vector is believed: each row's is free, as in arbitrary orientations.

    The parameters are fitted anew beside the free vectors, so that they too are what parity alone makes of them.
    """
    baseline, setting = start.baseline, start.baseline.setting
    turns = [p.columns for p in components(setting) if size or p.words != SIZE]
    if not turns:
        return replace(start, traces=(), patterns=())
    sigma = np.full((setting.rows, len(turns)), np.inf)
    free = refitted(renoised(replace(baseline, row=np.stack(turns, axis=-1), row_sigma=sigma)))
    return begun_with(start, free)


def renoised(free: Baseline) -> Baseline:
    """A baseline in parity space with the noise that is not stated estimated there (restricted likelihood).

    The others of a kind are taken to be alike, as everywhere (`calibration.noise`).
    """
    variance, m = free.variance.copy(), len(free.unstated)
    if not free.unstated.any():
        return free
    for _ in range(ROUNDS):
        residuals = WhitenedResiduals.of(replace(free, variance=variance))
        rows = residuals.rows
        own = residuals.sensor_of_row[:rows] == np.arange(m)[:, None]
        energy, freedom = own @ residuals.z[:rows] ** 2, own @ residuals.row_freedom
        value = np.where(free.unstated, variance.mean(axis=0), np.nan)
        expected = typical(value[None], free.unstated[None], free.setting.norm)[0] / variance.mean(axis=0)
        energy, freedom = with_the_others(energy, freedom, expected)
        variance = variance * np.where(free.unstated, energy / np.maximum(freedom, 1.0), 1.0)
    return replace(free, variance=variance)
