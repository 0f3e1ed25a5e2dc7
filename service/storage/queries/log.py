"""What was turned away, and who did what."""

from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime
from typing import Any

from estimator.errors import Problem
from service.storage.queries.base import Queries
from service.storage.tables import AuditRow, RefusalRow


class Log(Queries):
    """Refused uploads and the audit trail."""

    def refusal(self, at: datetime, filename: str, sha256: str, size: int, problems: Sequence[Problem]) -> None:
        """Records an upload that could not be used."""
        listed = [asdict(problem) for problem in problems]
        self._session.add(RefusalRow(at=at, filename=filename, sha256=sha256, size=size, problems=listed))

    def audit(self, at: datetime, who: str, action: str, subject: str, details: dict[str, Any]) -> None:
        """Records who did what; never changed afterwards."""
        self._session.add(AuditRow(at=at, who=who, action=action, subject=subject, details=details))
