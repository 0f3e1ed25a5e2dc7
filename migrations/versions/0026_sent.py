"""Long files that were received whole wait as jobs.

Revision: 0026, after 0025
"""

import sqlalchemy as sa
from alembic import op

revision = "0026"
down_revision = "0025"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """No file waits yet."""
    op.add_column("jobs", sa.Column("sent", sa.JSON(), nullable=True))
    op.add_column("jobs", sa.Column("is_storing", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("jobs", sa.Column("session", sa.String(20), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("refusal", sa.Integer(), nullable=True))


def downgrade() -> None:
    """A file that waits is to be sent again; what was stored stays, without its job."""
    op.execute("DELETE FROM jobs WHERE kind = 'upload'")
    for name in ("refusal", "session", "is_storing", "sent"):
        op.drop_column("jobs", name)
