"""Work beside the requests that failed says why, where it is asked for.

Revision: 0029, after 0028
"""

import sqlalchemy as sa
from alembic import op

revision = "0029"
down_revision = "0028"
branch_labels = None
depends_on = None

QUEUES = ("pending_diagnoses", "pending_outlooks", "pending_groups", "pending_summaries", "recomputations")
FAILED = "state = 'failed'"
KEPT_FAILED = ("diagnoses", "deliveries", "jobs")
"""Tables whose rows say that something failed: few of many, counted all the time."""


def upgrade() -> None:
    """Adds the reasons of failures; none is recorded yet."""
    for table in QUEUES:
        op.add_column(table, sa.Column("failed", sa.Text(), nullable=True))
    op.create_table(
        "failed_derivations",
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("failed", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("unit_id", name="pk_failed_derivations"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_failed_derivations_unit_id"),
    )
    for table in KEPT_FAILED:
        own = {"sqlite_where": sa.text(FAILED), "postgresql_where": sa.text(FAILED)}
        op.create_index(f"ix_{table}_failed", table, ["state"], **own)


def downgrade() -> None:
    """Drops the reasons of failures, which are in the log too."""
    for table in KEPT_FAILED:
        op.drop_index(f"ix_{table}_failed", table)
    op.drop_table("failed_derivations")
    for table in QUEUES:
        op.drop_column(table, "failed")
