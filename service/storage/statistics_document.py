"""What is kept of a session for its groups, as bytes and back: imu-session-statistics/2, deflated."""

import json
import zlib

from estimator.groups import SessionStatistics
from service.storage.json_text import json_text


def packed(record: SessionStatistics) -> bytes:
    """What `unpacked` reads."""
    return zlib.compress(json_text(record.to_dict(), finite=False).encode())


def unpacked(content: bytes) -> SessionStatistics:
    """The record that was written."""
    return SessionStatistics.from_dict(json.loads(zlib.decompress(content)))
