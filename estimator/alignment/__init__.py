"""Alignment on a turntable and mounting errors from a rate table.

sins       states, transition, what is measured         kalman, filtering   the filter
axes       m sensors → three axes                       noise               from the readings at rest
positions  stops, and whether the rows make sense       coarse, strapdown   start and attitude
align, rate_table                                       the two programmes
observability                                           what a plan can see, before it is run
simulate                                                sessions whose truth is known
"""

from estimator.alignment.align import align
from estimator.alignment.rate_table import rate_table
from estimator.alignment.results import AlignmentResult, RateTableResult
from estimator.alignment.sins import InertialModel

__all__ = ["AlignmentResult", "InertialModel", "RateTableResult", "align", "rate_table"]
