"""What was turned away."""

from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime

from estimator.errors import Problem
from service.storage.queries.base import Queries
from service.storage.tables import RefusalRow


class Log(Queries):
    """Refused uploads."""

    def refusal(self, at: datetime, filename: str, sha256: str, size: int, problems: Sequence[Problem]) -> int:
        """Records an upload that could not be used, and returns its number."""
        listed = [asdict(problem) for problem in problems]
        row = RefusalRow(at=at, filename=filename, sha256=sha256, size=size, problems=listed)
        self._session.add(row)
        self._session.flush()
        return row.id
