"""The trail holds the longest login with the longest label of a token: a text of both is eight characters longer.

SQLite holds no text to its length.

Revision: 0043, after 0042
"""

import sqlalchemy as sa
from alembic import op

revision = "0043"
down_revision = "0042"
branch_labels = None
depends_on = None

SHORT, LONG = 260, 300


def upgrade() -> None:
    """The column becomes wider."""
    _retype(SHORT, LONG)


def downgrade() -> None:
    """A text that no longer fits loses its end, and its line then fails the check of the chain."""
    _retype(LONG, SHORT)


def _retype(since: int, to: int) -> None:
    if op.get_context().dialect.name == "postgresql":
        using = f"left(account, {to})"
        op.alter_column("audit", "account", existing_type=sa.String(since), type_=sa.String(to), postgresql_using=using)
