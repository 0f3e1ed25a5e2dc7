"""The catalogue of causes: the physical effects that the baseline simulation lacks, each one small class."""

from estimator.causes.catalogue import CATALOGUE, OF_SEVERAL, ON_TURNTABLE, UNEXPLAINED, cause, find
from estimator.causes.contract import (
    Cause,
    CommonCause,
    Entry,
    RecordCorrection,
    SensorCause,
    Setting,
    Shape,
    Signature,
)

__all__ = [
    "CATALOGUE",
    "OF_SEVERAL",
    "ON_TURNTABLE",
    "UNEXPLAINED",
    "Cause",
    "CommonCause",
    "Entry",
    "RecordCorrection",
    "SensorCause",
    "Setting",
    "Shape",
    "Signature",
    "cause",
    "find",
]
