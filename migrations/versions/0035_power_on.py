"""Adds the time since power-on at the start of a session, and the sentence on what the named causes gain.

What earlier releases kept states neither.

Revision: 0035, after 0033
"""

import sqlalchemy as sa
from alembic import op

revision = "0035"
down_revision = "0034"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Two columns; in rows of earlier releases both are NULL."""
    op.add_column("sessions", sa.Column("time_since_power_on", sa.Double(), nullable=True))
    op.add_column("diagnoses", sa.Column("gain_in_words", sa.String(), nullable=True))


def downgrade() -> None:
    """The session's file states the one again, a new diagnosis the other."""
    op.drop_column("diagnoses", "gain_in_words")
    op.drop_column("sessions", "time_since_power_on")
