"""The JSON text that accompanies the columns of a binary file."""

from collections.abc import Mapping

from estimator.message import say
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems
from service.kit.limits import in_force, refusal

KEY = "imu-session"
"""Under which a table's file keeps the session's other fields."""


def with_metadata(text: str, columns: Mapping[str, object], filename: str) -> dict[str, object]:
    """The document of a session: the JSON metadata, and the columns as its table."""
    problems = Problems(filename, in_force().extent)
    document = parse_json(text, problems)
    problems.raise_if_any()
    if "table" in document:
        raise refusal(
            filename, say("stands in the {key} metadata; keep the readings in the columns only", key=KEY), "table"
        )
    return document | {"table": dict(columns)}
