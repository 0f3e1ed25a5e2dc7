"""What is kept of a session for its groups, as bytes and back: imu-session-statistics/2, deflated."""

import json
import zlib

from estimator.groups import SessionStatistics


def packed(record: SessionStatistics) -> bytes:
    """What `unpacked` reads."""
    return zlib.compress(json.dumps(record.to_dict(), separators=(",", ":")).encode())


def unpacked(content: bytes) -> SessionStatistics:
    """The record that was written."""
    return SessionStatistics.from_dict(json.loads(zlib.decompress(content)))
