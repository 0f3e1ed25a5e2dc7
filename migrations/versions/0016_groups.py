"""Statistics of sessions for their groups, and the diagnoses of groups.

Revision: 0016, after 0015
"""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """A starting service asks for every group; the statistics of its sessions are made with it."""
    op.create_table(
        "session_statistics",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("format", sa.String(40), nullable=False),
        sa.Column("document", sa.LargeBinary(), nullable=True),
        sa.Column("why", sa.String(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("estimator_version", sa.String(40), nullable=False),
        sa.PrimaryKeyConstraint("session_id", name="pk_session_statistics"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_session_statistics_session_id"),
    )
    op.create_table(
        "group_diagnoses",
        sa.Column("level", sa.String(10), nullable=False),
        sa.Column("group_id", sa.Integer(), nullable=False),
        sa.Column("rests_on", sa.String(64), nullable=False),
        sa.Column("sessions", sa.Integer(), nullable=False),
        sa.Column("summary", sa.String(), nullable=False),
        sa.Column("document", sa.LargeBinary(), nullable=True),
        sa.Column("estimator_version", sa.String(40), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("level", "group_id", name="pk_group_diagnoses"),
    )
    op.create_table(
        "pending_groups",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("level", sa.String(10), nullable=False),
        sa.Column("group_id", sa.Integer(), nullable=False),
        sa.Column("asked_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("claimed_until", sa.DateTime(timezone=True), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_pending_groups"),
    )
    op.create_index("ix_pending_groups_level_group_id", "pending_groups", ["level", "group_id"])


def downgrade() -> None:
    """All of it can be made again."""
    op.drop_index("ix_pending_groups_level_group_id", "pending_groups")
    op.drop_table("pending_groups")
    op.drop_table("group_diagnoses")
    op.drop_table("session_statistics")
