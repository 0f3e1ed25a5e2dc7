"""What a model revision rests on, as it is stored."""

from typing import Any

from service.models.records import Evidence
from service.storage.documents import STORED


def evidence_to_dict(evidence: Evidence | None) -> dict[str, Any]:
    """What a model revision rests on; empty of one that withdraws another."""
    return {} if evidence is None else STORED.written(evidence)


def evidence_from_dict(entry: dict[str, Any]) -> Evidence | None:
    """What `evidence_to_dict` wrote."""
    return STORED.read(Evidence, entry) if entry else None
