"""MCAP: its messages of sensor_msgs/msg/Imu, checked by their sums. Source: the MCAP format specification."""

import io
import struct
from collections.abc import Iterator

import zstandard
from mcap.exceptions import McapError
from mcap.reader import make_reader

from service.ingest.logs.readers import Contents
from service.ingest.logs.ros import CDR, IMU, Message, contents
from service.kit.limits import refusal

DAMAGED = (
    McapError,
    zstandard.ZstdError,
    RuntimeError,  # of lz4
    struct.error,
    ValueError,
    LookupError,
    OverflowError,
)
"""Raised by the libraries for truncated or overwritten files."""
UNREADABLE = "is damaged or truncated; record or copy it again, or repair it with `mcap recover`"


def read(content: bytes, filename: str) -> Contents:
    """The IMUs of a file; FormatError where it is damaged or has no end."""
    return contents(_messages(content, filename), filename)


def _messages(content: bytes, filename: str) -> Iterator[Message]:
    try:
        for schema, channel, message in make_reader(io.BytesIO(content), validate_crcs=True).iter_messages(
            log_time_order=False
        ):
            if schema is not None and schema.name == IMU and channel.message_encoding == CDR:
                yield channel.topic, message.log_time, message.data
    except DAMAGED as fault:
        if hasattr(fault, "problems"):
            raise
        raise refusal(filename, UNREADABLE) from fault
