"""What was turned away."""

from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime

from estimator.errors import Problem
from service.storage.queries.base import Queries
from service.storage.tables import RefusalRow


class Log(Queries):
    """Refused uploads."""

    def refusal(self, at: datetime, filename: str, sha256: str, size: int, problems: Sequence[Problem]) -> None:
        """Records an upload that could not be used."""
        listed = [asdict(problem) for problem in problems]
        self._session.add(RefusalRow(at=at, filename=filename, sha256=sha256, size=size, problems=listed))
