"""Noise of a session's sensors from its rests: the curve, beside the terms, which are parameters.

Revision: 0025, after 0024
"""

import sqlalchemy as sa
from alembic import op

revision = "0025"
down_revision = "0024"
branch_labels = None
depends_on = None

TERMS = ("quantisation", "white-noise", "bias-instability", "random-walk")
PARAMETERS = sa.table("parameters", sa.column("parameter"))


def upgrade() -> None:
    """A table of its own; the terms need none."""
    op.create_table(
        "session_noise",
        sa.Column("session_id", sa.String(20), sa.ForeignKey("sessions.id"), primary_key=True),
        sa.Column("document", sa.LargeBinary(), nullable=False),
        sa.Column("estimator_version", sa.String(40), nullable=False),
        sa.Column("made_at", sa.DateTime(timezone=True), nullable=False),
    )


def downgrade() -> None:
    """Drops the noise terms, which earlier releases do not know."""
    op.drop_table("session_noise")
    op.execute(sa.delete(PARAMETERS).where(PARAMETERS.c.parameter.in_(TERMS)))
