"""Diagnoses and outlooks that are still to be made, and who is at them.

Revision: 0013, after 0012
"""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """A starting service asks for those of the sessions that have none."""
    op.create_table(
        "pending_diagnoses",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("asked_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("ticket", sa.String(32), nullable=False),
        sa.Column("not_before", sa.DateTime(timezone=True), nullable=True),
        sa.Column("claimed_by", sa.String(32), nullable=True),
        sa.Column("claimed_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("session_id", name="pk_pending_diagnoses"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_pending_diagnoses_session_id"),
    )
    op.create_index("ix_pending_diagnoses_asked_at", "pending_diagnoses", ["asked_at"])
    op.create_table(
        "pending_outlooks",
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("asked_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("ticket", sa.String(32), nullable=False),
        sa.Column("claimed_until", sa.DateTime(timezone=True), nullable=True),
        sa.PrimaryKeyConstraint("unit_id", name="pk_pending_outlooks"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_pending_outlooks_unit_id"),
    )


def downgrade() -> None:
    """A session without a diagnosis is one whose diagnosis is pending; outlooks that waited are made with their unit's
    next session, or where their type has told more."""
    op.drop_table("pending_outlooks")
    op.drop_table("pending_diagnoses")
