"""The fleet as columns, for other programs."""

from collections.abc import Sequence
from typing import Any

import polars as pl

from service.fleet.condition import UnitSummary
from service.judging.words import unit_in_words
from service.web.files import TIME, table_of

FLEET_COLUMNS = {
    "serial": pl.String(), "unit_type": pl.String(), "simulated": pl.Boolean(), "sessions": pl.Int64(),
    "last_session": pl.String(), "last_at": TIME, "verdict": pl.String(), "is_reference": pl.Boolean(),
    "reason": pl.String(),
    "worst_sensor": pl.String(), "worst_parameter": pl.String(), "margin": pl.Float64(),
    "diagnosis": pl.String(), "flags": pl.Int64(), "due": TIME, "lot": pl.String(),
    "said": pl.String(), "last_at_ms": pl.Int64(), "due_ms": pl.Int64(),
}  # fmt: skip


def fleet_table(units: Sequence[UnitSummary]) -> pl.DataFrame:
    """One row a unit."""
    return table_of([_unit_row(unit) for unit in units], FLEET_COLUMNS)


def _unit_row(unit: UnitSummary) -> dict[str, Any]:
    return vars(unit) | {"said": unit_in_words(unit), "last_at_ms": unit.last_at_ms, "due_ms": unit.due_ms}
