"""rosbag2 in SQLite (`.db3`): its messages of sensor_msgs/msg/Imu. Source: rosbag2_storage_sqlite3's schema.

The database is opened in memory: nothing is written, and no file beside it is opened.
"""

import sqlite3
from collections.abc import Iterator

from service.ingest.logs.readers import Contents
from service.ingest.logs.ros import CDR, IMU, Message, contents
from service.kit.limits import refusal

QUERY = (
    "SELECT topics.name, messages.timestamp, messages.data FROM messages JOIN topics ON topics.id = messages.topic_id "
    "WHERE topics.type = ? AND topics.serialization_format = ? ORDER BY messages.id"
)
JOURNAL_MODE, ROLLBACK = slice(18, 20), b"\x01\x01"
"""Bytes of the header that name the journal mode (SQLite file format, 1.3.3): a copy in memory has no write-ahead log,
so rollback is set, which reads the same."""
PAGE, PAGES = slice(16, 18), slice(28, 32)
"""Bytes of the header with the size and number of pages (1.3.2 and 1.3.7)."""
LARGEST = 65_536
"""Bytes of a page, which the header writes as 1."""
UNREADABLE = "is damaged or not a rosbag2 of ROS 2 in SQLite; record or copy it again"


def read(content: bytes, filename: str) -> Contents:
    """The IMUs of a bag; FormatError where it is damaged or another kind of database."""
    return contents(_messages(content, filename), filename)


def _messages(content: bytes, filename: str) -> Iterator[Message]:
    if len(content) < _stated(content):
        raise refusal(filename, UNREADABLE)
    connection = sqlite3.connect(":memory:")
    try:
        connection.deserialize(content[: JOURNAL_MODE.start] + ROLLBACK + content[JOURNAL_MODE.stop :])
        connection.execute("PRAGMA trusted_schema = OFF")
        for topic, logged, data in connection.execute(QUERY, (IMU, CDR)):
            if not (isinstance(topic, str) and isinstance(logged, int) and isinstance(data, bytes)):
                raise refusal(filename, UNREADABLE)
            yield topic, logged, data
    except sqlite3.Error as fault:
        raise refusal(filename, UNREADABLE) from fault
    finally:
        connection.close()


def _stated(content: bytes) -> int:
    """Bytes stated in the header: a truncated file is shorter, and SQLite may read it without an error."""
    page = int.from_bytes(content[PAGE], "big")
    return (LARGEST if page == 1 else page) * int.from_bytes(content[PAGES], "big")
