"""Parity: the health of a redundant block from any recording, still or moving, without a stand.

Theory
------
m > 3 sensors with input axes H (m, 3) measure one vector n (specific force; for gyros the rate). V (m, d), d = m − 3,
spans the null space of Hᵀ, so with a = u/K − b − c·a² by the reference calibration, p = Vᵀa is free of the motion:

    p(t) = Vᵀ·ΔA·x(t) + noise,      x = (1, n/g),      ΔA (m, 4) the sensors' changes since the reference

Row i of ΔA is Δb·(1, 0) + Δln K·(b, g·e) + g·(0, Δe). Regression of p on x, block by block, gives Θ = Vᵀ·ΔA: d numbers
for the change of bias and 3 d for those of scale and axes. ΔA = H·X with any X (3, 4) leaves no trace: three numbers of
bias and nine of scale and axes, which a common bias, a turn, a stretch or a shear of the applied vector explains.
Motion moves p of sound sensors too, by lever arms, delays and vibration: unknowns beside Θ, each of a size it has.

reference   what the recording is compared with: H, V, and how a sensor's change shows
ledger      recording → means of blocks, in bounded memory
motion      the angular rate that a recording shows, from the gyros among its columns
rest        whether a block of a recording is at rest in truth
blocks      which blocks are used, and how they are grouped into stretches that can be taken for independent
nuisance    what motion does to sound sensors
regression  Θ with its covariance: noise of any colour, from the recording itself, and that of the reference
freed       Θ with its covariance, freed of what motion does
hypotheses  which sensor: generalised likelihood ratio, and what the recording could have found
isolation   from what size on a change is attributed to its sensor
standing    sensors that are dead, by their raw readings
course      parity block by block, with what noise and motion do to it
scan        when a course begins to differ: the likelihood ratio of every onset and end
shapes      how a sensor fails from one moment on
signs       two sensors exchanged, noise that grows
onset       faults that begin within the recording
check       the whole
Source: parity space for redundant inertial sensors, Potter and Suman (1977); generalised likelihood ratio, Daly, Gai
and Harrison (1979); of the onset, Willsky and Jones (1976).
"""

from typing import TYPE_CHECKING

from estimator.on_demand import names_on_demand

if TYPE_CHECKING:
    from estimator.parity.check import ParityAccumulator, parity_check
    from estimator.parity.results import CourseFault, ParityResult
else:
    __getattr__ = names_on_demand(
        __name__,
        {
            "check": "ParityAccumulator parity_check",
            "results": "CourseFault ParityResult",
        },
    )

__all__ = ["CourseFault", "ParityAccumulator", "ParityResult", "parity_check"]
