"""Sessions keep a digest of their readings alone, so that the same ones under another serial number are recognised.

Sessions from before keep none: their readings lie in files, which a change of the schema does not read.

Revision: 0030, after 0029
"""

import sqlalchemy as sa
from alembic import op

revision = "0030"
down_revision = "0029"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Empty for what is stored."""
    op.add_column("sessions", sa.Column("readings_digest", sa.String(64), nullable=True))
    op.create_index("ix_sessions_readings_digest", "sessions", ["readings_digest"])


def downgrade() -> None:
    """Copies are no longer recognised."""
    op.drop_index("ix_sessions_readings_digest", "sessions")
    op.drop_column("sessions", "readings_digest")
