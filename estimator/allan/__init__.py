"""Allan terms: what a block's sensors do at rest, from the rests of raw logs and from long static records.

Theory
------
The readings y of a sensor at rest, averaged over τ, change from one average to the next by the Allan variance σ²(τ).
Four noises of a sensor show as powers of τ (IEEE Std 952-1997, annex C; IEEE Std 1293-2018):

    σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)·B² + K²·τ/3

N white noise (angle or velocity random walk), B bias instability (flicker), K random walk of the rate or the
acceleration, Q quantisation of the angle or the velocity.

variance   rests → the overlapping Allan variance at octaves of τ, pooled over the rests
model      the four terms, and the covariance of the estimates that they imply
fit        the sizes of greatest quasi-likelihood, each with its effective degrees of freedom, and where they hold
rests      a raw log → the stretches in which the block was at rest
estimate   the whole, for every sensor of a session
growth     records of a unit → which terms became larger
"""

from typing import TYPE_CHECKING

from estimator.on_demand import names_on_demand

if TYPE_CHECKING:
    from estimator.allan.estimate import allan_terms
    from estimator.allan.rests import Rests, rests_of
    from estimator.allan.results import BlockNoise
else:
    __getattr__ = names_on_demand(
        __name__,
        {
            "estimate": "allan_terms",
            "results": "BlockNoise",
            "rests": "Rests rests_of",
        },
    )

__all__ = ["BlockNoise", "Rests", "allan_terms", "rests_of"]
