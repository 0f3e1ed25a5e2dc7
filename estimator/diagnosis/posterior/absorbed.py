"""What earlier sessions absorbed of an effect that has acted since before them."""

from collections.abc import Hashable, Sequence
from dataclasses import fields

import numpy as np

from estimator.causes.contract import SensorCause, Setting, Shape
from estimator.content import held, once
from estimator.diagnosis.residuals.whitened import ParameterChange, WhitenedResiduals
from estimator.session import Array

RECORDED = frozenset({"time", "temperature", "vibration"})
"""Needs of a cause that differ between sessions of one schedule."""
NOT_SEEN = RECORDED | {"parameters"}
"""Attributes of a setting that do not tell earlier sessions apart: all are seen at the present parameters."""


def absorbed_before(residuals: WhitenedResiduals, cause: SensorCause, shapes: Sequence[Shape]) -> Array | None:
    """(P, S·q) dimensionless: what the history's calibrations absorbed of the same effects; None if that is unknown.

    It is known on a stand, of causes that may act in every session at every row; in orientations of what settles after
    switching on, which depends on nothing but the time.
    """
    change = residuals.change
    if change is None or "row" in cause.nonlinear_units:
        return None
    absorbed = np.zeros((len(change.deviation), 1))
    for setting, absorbs in alike(change, RECORDED & cause.needs):
        if (setting.beta is None and not cause.since_power_on) or not cause.available(setting):
            return None
        each = [absorbed_terms(absorbs[:, :, i], terms) for i, terms in cause.terms_of(setting, shapes)]
        absorbed = absorbed + np.concatenate(each, axis=1)
    return absorbed


@once
def alike(change: ParameterChange, recorded: frozenset[str]) -> tuple[tuple[Setting, Array], ...]:
    """Settings of the history that differ for a cause that looks at nothing ``recorded`` but this, each with what all
    sessions in it absorb: (P, R, m) per m/s² (rad/s). A signature at one's parameters depends on nothing else."""
    groups: dict[Hashable, tuple[Setting, Array]] = {}
    for earlier in change.earlier:
        setting = earlier.setting
        seen = [
            getattr(setting, attribute.name)
            for attribute in fields(setting)
            if attribute.name not in NOT_SEEN - recorded
        ]
        key = held(seen)
        absorbed = groups[key][1] + earlier.absorbs if key in groups else earlier.absorbs
        groups[key] = setting, absorbed
    return tuple(groups.values())


def absorbed_terms(absorbs: Array, terms: Array) -> Array:
    """(P, S·q) dimensionless: what a session absorbs, (P, R) of one sensor, per m/s², of terms (S, R, q), m/s²."""
    return np.asarray(absorbs @ terms.swapaxes(0, 1).reshape(terms.shape[1], -1))
