"""Raw files, before they are averaged: what is no reading is corrected or left out by name, or the file refused.

findings  what was found, and how it is said            samples   readings, channel by channel and vector by vector
clock     times: rolled over, doubled, in other units   screen    both over a whole file, part after part
wild      samples far from all others of their rest, for means that they do not move

Nothing here judges a sensor: a finding is of the recording. All of it can be declined, by kind or altogether.
"""

from estimator.screening.findings import KINDS, OFF, Screening, declined_by
from estimator.screening.screen import JUDGED_BY_PARITY, Screen
from estimator.screening.wild import without_wild
from estimator.session import ScreenFinding

__all__ = ["JUDGED_BY_PARITY", "KINDS", "OFF", "Screen", "ScreenFinding", "Screening", "declined_by", "without_wild"]
