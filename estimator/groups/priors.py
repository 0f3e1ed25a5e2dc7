"""Every constant of the model of a group: a prior with its reason, or a decision on the posterior."""

import numpy as np

ALPHA = 0.01
"""Chance that a group without an effect ever gets a name, for the whole of its life."""

ENOUGH = float(-np.log(ALPHA))
"""ln e-value of a name."""

STRENGTHS = (0.5, 2.0, 8.0)
"""κ: strengths of the effect in one session, standard errors, each with a third of the prior. From what only some
hundred sessions show to what each shows by itself; in between the evidence is within a factor of two of the best."""

SPREADS = (1.5, 3.0, 8.0)
"""τ in the same unit: below 1.5 no single session adds to the evidence of a spread."""

SAME, VARYING, SINCE = 0, 1, 2
FORMS = (0.6, 0.2, 0.2)
"""Prior share of an effect that is always the same, differs every time, began at some session: what lasts is what
groups are pooled for."""

GROWTH = 1.25
"""Ratio between sessions at which an effect is tried to begin, counted from the first: one that begins between two of
them loses at most a fifth of its sessions to the later.
"""

UNIT, TYPE, STAND = "unit", "type", "stand"
LEVELS = (UNIT, TYPE, STAND)
SHARES = {
    UNIT: {UNIT: 0.5, TYPE: 0.0, STAND: 0.5},
    TYPE: {UNIT: 0.3, TYPE: 0.4, STAND: 0.3},
    STAND: {UNIT: 0.3, TYPE: 0.2, STAND: 0.5},
}
"""Prior share of the levels of effects in a group of each level: most to the group's own, for which it is pooled."""

SHARED = 0.2
"""Part of a level's share that sensor causes on every sensor of a kind have."""

OUTSIDE = 0.2
"""Prior odds that an effect is in no catalogue: one in six."""

FURTHER = float(np.log(100))
"""Cost of every name beyond the first at one place, as within one session."""

NEARLY = 0.05
"""Share of what the names at a place explain that may be left beside them: a cause that is described nearly is still
that cause."""

DOUBT = 0.005
"""Probability of an unknown course from which on it is an alternative, as within one session."""

STILL = 0.01
"""p-value that the rest of the sessions must reach without the one, or the unit, that shows an effect most."""

FEW = 4
"""One session in so many may have an effect by itself that is no affair of the group; more have something else."""

LARGEST = 0.3
"""Largest part of the applied vector that an effect may be, as within one session."""

MOST = 8
"""Effects of a group; what needs more is no sum of causes, and ends the search."""
