"""Robust detection of outliers in a population of units, production lots or stands.

Rates of one parameter, r_i ± s_i, are drawn about a common centre with a spread τ of their own (random effects):
r_i ~ N(μ, τ² + s_i²). μ is the median. τ comes from the median absolute deviation, which half of the rates may spoil
without moving it: τ² is the least for which the median of |r_i − μ|/√(τ² + s_i²) is that of a normal, 0.6745.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtri

from estimator.session import Array
from estimator.significance import single_level

NORMAL_MEDIAN = float(ndtri(0.75))
"""Median of |x| of a standard normal."""


def spread(values: Array, sigmas: Array) -> tuple[float, float]:
    """Robust centre and spread of a population, what its members' own uncertainties explain taken off.

    Parameters
    ----------
    values, sigmas : (n,) one sigma each, both in any one unit: rates relative to the tolerance, relative changes, rad.
    """
    centre = float(np.median(values))
    away = np.abs(values - centre)

    def excess(tau: float) -> float:
        return float(np.median(away / np.sqrt(tau**2 + sigmas**2 + 1e-300))) - NORMAL_MEDIAN

    widest = float(away.max()) / NORMAL_MEDIAN
    if widest == 0 or excess(0.0) <= 0:
        return centre, 0.0
    return centre, float(brentq(excess, 0.0, widest * 1.01))


def standing(values: Array, sigmas: Array, centre: float, tau: float) -> Array:
    """Distance of each of (n,) values from the centre, in units of its expected spread; units as in `spread`."""
    return np.asarray((values - centre) / np.sqrt(tau**2 + sigmas**2 + 1e-300))


def outliers(z: Sequence[float], level: float = 0.01, among: int = 0) -> tuple[bool, ...]:
    """Marks the members that are further out than the furthest of n is with probability ``level`` (Šidák).

    ``z`` may be those alone that are furthest out of ``among`` members.
    """
    single = single_level(level, max(len(z), among))
    return tuple(bool(x) for x in np.abs(np.array(z)) > -ndtri(single / 2))


def group_standing(rates: Sequence[tuple[float, float]], groups: Sequence[str]) -> dict[str, float]:
    """Distance of each group's (a production lot's) mean rate from the population, in sigmas.

    Parameters
    ----------
    rates : value and sigma of every member.
    groups : name of every member's group; the empty name is none.
    """
    values, sigmas = np.array(rates, dtype=float).T
    centre, tau = spread(values, sigmas)
    standings = {}
    for name in dict.fromkeys(groups):
        members = np.array([group == name for group in groups])
        if name and members.sum() > 1:
            variance = float((tau**2 + sigmas[members] ** 2).sum()) / float(members.sum()) ** 2
            standings[name] = float((values[members].mean() - centre) / np.sqrt(variance + 1e-300))
    return standings
