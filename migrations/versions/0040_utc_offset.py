"""The offset from UTC of the place where a session was measured, as its file states it.

Sessions of earlier releases keep UTC.

Revision: 0040, after 0039
"""

import sqlalchemy as sa
from alembic import op

revision = "0040"
down_revision = "0039"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One column, minutes, NULL in the rows that are there."""
    op.add_column("sessions", sa.Column("utc_offset", sa.Integer(), nullable=True))


def downgrade() -> None:
    """The moments stay, in UTC."""
    op.drop_column("sessions", "utc_offset")
