"""imu-calibration/1 as it is kept."""

import zlib
from dataclasses import dataclass

from estimator.results import Calibration
from service.storage.documents import STORED
from service.storage.json_text import json_text

LEVEL = 4
"""Of deflate: 4 % more bytes than the usual 6, in 40 % of the time; an upload waits for it."""


@dataclass(frozen=True)
class Packed:
    """A calibration as it is kept."""

    method: str
    document: bytes
    """The whole imu-calibration/1, deflated."""


def pack(calibration: Calibration) -> Packed:
    """Ready to be stored, so that no transaction waits for it."""
    return Packed(calibration.method, zlib.compress(json_text(STORED.written(calibration)).encode(), LEVEL))
