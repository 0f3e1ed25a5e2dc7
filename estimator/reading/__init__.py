"""Reading a session file: imu-session/1 as JSON or CSV → CalibrationSession, or every problem with its place.

source    where the bytes come from, and what they are (json_text, csv_text)
fields    one object of the file        keys     what it may hold
sensors, setting, table                 the parts of a session (columns, shape: of the table)
schedule  whether the rows can support the programme
extent    how much a file may hold
problems  the faults found on the way; none of the parts raises one by itself
"""

from estimator.reading.problems import Extent
from estimator.reading.session_file import read_session

__all__ = ["Extent", "read_session"]
