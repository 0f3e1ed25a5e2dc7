"""Background work has one order: what somebody looks at, what somebody uploaded, what rests on many sessions, and the
demonstration, whose units are marked.

Revision: 0045, after 0044
"""

import sqlalchemy as sa
from alembic import op

revision = "0045"
down_revision = "0044"
branch_labels = None
depends_on = None

SHOWN = """
UPDATE units SET is_demonstration = {true} WHERE id IN (
    SELECT s.unit_id FROM sessions s JOIN audit a ON a.action = 'upload' AND a.subject = s.id
    GROUP BY s.unit_id HAVING min(a.who) = 'demonstration' AND max(a.who) = 'demonstration'
)
"""
"""Marks the units that nobody else uploaded a session of."""
RANKS = (
    "UPDATE work SET rank = 2 WHERE kind IN ('group', 'summary', 'recomputation')",
    "UPDATE work SET rank = 3 WHERE kind = 'diagnosis' AND key IN ("
    "SELECT s.id FROM sessions s JOIN units u ON u.id = s.unit_id WHERE u.is_demonstration)",
    "UPDATE work SET rank = 3 WHERE kind IN ('outlook', 'derivation') AND key IN ("
    "SELECT serial FROM units WHERE is_demonstration)",
)
"""Groups of the demonstration get theirs when they are asked for again."""


def upgrade() -> None:
    """Work that waits gets its rank."""
    op.add_column("units", sa.Column("is_demonstration", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("work", sa.Column("rank", sa.Integer(), nullable=False, server_default="1"))
    op.create_index("ix_work_rank_asked_at", "work", ["rank", "asked_at"])
    op.execute(SHOWN.format(true="true" if op.get_context().dialect.name == "postgresql" else "1"))
    for statement in RANKS:
        op.execute(statement)


def downgrade() -> None:
    """Work waits in the order of its requests."""
    op.drop_index("ix_work_rank_asked_at", "work")
    op.drop_column("work", "rank")
    op.drop_column("units", "is_demonstration")
