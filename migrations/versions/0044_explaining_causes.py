"""The evidence of a diagnosis for flags states the causes that explain it, so that accepting one resolves the flag.

Revision: 0044, after 0043
"""

import json
import zlib
from collections.abc import Callable
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0044"
down_revision = "0043"
branch_labels = None
depends_on = None

OF_CAUSES = ("cause", "stand")
"""Matters of concerns that causes explain."""
PLAIN = 4
"""Parts of a concern that states no causes."""
DIAGNOSES = sa.table(
    "diagnoses", sa.column("session_id", sa.String), sa.column("document", sa.LargeBinary), sa.column("tells", sa.JSON)
)


def upgrade() -> None:
    """The causes of each concern, from the document of its diagnosis."""
    _rewrite(_explained)


def downgrade() -> None:
    """The concerns stay as they are, without their causes."""
    _rewrite(lambda concern, _: concern[:PLAIN])


def _rewrite(change: Callable[[list[Any], dict[str, Any]], list[Any]]) -> None:
    bind = op.get_bind()
    kept = sa.select(DIAGNOSES.c.session_id, DIAGNOSES.c.tells).where(DIAGNOSES.c.tells.is_not(None))
    for id, evidence in bind.execute(kept).all():
        if not evidence or not any(concern[0] in OF_CAUSES for concern in evidence["concerns"]):
            continue
        held = bind.scalar(sa.select(DIAGNOSES.c.document).where(DIAGNOSES.c.session_id == id))
        document = {} if held is None else json.loads(zlib.decompress(held))
        concerns = [change(c, document) if c[0] in OF_CAUSES else c for c in evidence["concerns"]]
        statement = sa.update(DIAGNOSES).where(DIAGNOSES.c.session_id == id)
        bind.execute(statement.values(tells={**evidence, "concerns": concerns}))


def _explained(concern: list[Any], document: dict[str, Any]) -> list[Any]:
    """The concern with the causes of the findings at its place and the sensors on which they act."""
    is_of_stand, place = concern[0] == "stand", concern[1]
    kinds = {sensor["name"]: sensor.get("kind", "accelerometer") for sensor in document["calibration"]["sensors"]}
    found = [
        f for f in document["findings"] if (not f["sensors"] if is_of_stand else not place or place in f["sensors"])
    ]
    causes = list(dict.fromkeys(name for f in found for name in (f["cause"], *f["alternatives"])))
    of_unit = dict.fromkeys(name for f in found for name in f["sensors"]) if not place else {place: None}
    sensors = [] if is_of_stand else [[name, kinds[name]] for name in of_unit]
    return [*concern[:PLAIN], causes, sensors] if causes else concern
