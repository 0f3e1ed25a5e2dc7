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
LARGEST = 2**31 - 1
"""Largest number that 32 bits hold."""


def upgrade() -> None:
    """Every size of a file gets 64 bits."""
    _retype(sa.Integer(), sa.BigInteger(), "size")


def downgrade() -> None:
    """A size that no longer fits becomes the largest that does; the files stay as they are."""
    _retype(sa.BigInteger(), sa.Integer(), f"LEAST(size, {LARGEST})")


def _retype(since: sa.Integer, to: sa.Integer, using: str) -> None:
    if op.get_context().dialect.name == "postgresql":
        for table in TABLES:
            op.alter_column(table, "size", existing_type=since, type_=to, postgresql_using=using)
