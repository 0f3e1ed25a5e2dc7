"""Files of 2 GiB and more have a size: on PostgreSQL, an integer ended one byte before.

On SQLite integers have 64 bits anyway. No view reads these columns, so those of 0018 stay as they are.

Revision: 0028, after 0027
"""

import sqlalchemy as sa
from alembic import op

revision = "0028"
down_revision = "0027"
branch_labels = None
depends_on = None

TABLES = ("sessions", "refusals", "attachments", "jobs")


def upgrade() -> None:
    """Every size of a file gets 64 bits."""
    _retype(sa.BigInteger(), sa.Integer())


def downgrade() -> None:
    """The database refuses it, and changes nothing, while it holds a size that no longer fits."""
    _retype(sa.Integer(), sa.BigInteger())


def _retype(to: sa.Integer, since: sa.Integer) -> None:
    if op.get_context().dialect.name == "postgresql":
        for table in TABLES:
            op.alter_column(table, "size", type_=to, existing_type=since)
