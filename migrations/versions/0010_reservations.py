"""Reservations about a verdict are stored with the diagnosis that they come from.

Revision: 0010, after 0009
"""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Diagnoses that are stored already bring no reservation. Reasons no longer claim more than a rule decides."""
    for table in ("sessions", "calibrations"):
        op.execute(
            f"UPDATE {table} SET reason = REPLACE(reason, 'tolerance, beyond doubt;', 'tolerance by more than U;')"  # noqa: S608 - our own tables
        )
    op.add_column("diagnoses", sa.Column("reservations", sa.JSON(), nullable=True))


def downgrade() -> None:
    """Drops the reservations."""
    op.drop_column("diagnoses", "reservations")
