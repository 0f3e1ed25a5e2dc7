"""rosbag2 in SQLite (`.db3`): its messages of sensor_msgs/msg/Imu. Source: rosbag2_storage_sqlite3's schema.

The database is opened in memory: nothing is written, and no file beside it is looked for.
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
FORMS, ROLLBACK = slice(18, 20), b"\x01\x01"
"""Bytes of the header that say by which journal it was written (SQLite file format, 1.3.3): a copy in memory has none,
so the older way is said there, which is the same to a reader."""
PAGE, PAGES = slice(16, 18), slice(28, 32)
"""Bytes of the header that say how large a page is, and how many there are (1.3.2 and 1.3.7)."""
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
        connection.deserialize(content[: FORMS.start] + ROLLBACK + content[FORMS.stop :])
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
    """Bytes that the header speaks of: a file that breaks off is shorter, and may be read without a word."""
    page = int.from_bytes(content[PAGE], "big")
    return (LARGEST if page == 1 else page) * int.from_bytes(content[PAGES], "big")
