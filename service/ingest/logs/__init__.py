"""Logs of flight controllers and robots (ULog, MCAP, rosbag2 in SQLite) → one table of all their IMUs on one clock.

Such a log states its channels, in SI, but not which unit it belongs to or where it stood: it is read like a table of
custom layout, with a mapping that the file itself proposes. The libraries come with ``pip install 'imu-health[logs]'``
and are imported when such a file is read.
"""

from service.ingest.logs.readers import log_of
from service.ingest.logs.table import LogTable

__all__ = ["LogTable", "log_of"]
