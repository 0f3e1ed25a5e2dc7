"""Sessions that are computed again because a model changed, and what moved; what is of a group itself.

Revision: 0017, after 0016
"""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One line a model revision and unit; tries that no process outlived are counted."""
    op.create_table(
        "recomputations",
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("asked_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("claimed_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("done_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("outcome", sa.JSON(), nullable=True),
        sa.PrimaryKeyConstraint("revision", "unit_id", name="pk_recomputations"),
        sa.ForeignKeyConstraint(["revision"], ["model_revisions.id"], name="fk_recomputations_revision"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_recomputations_unit_id"),
    )
    op.create_index(
        "ix_recomputations_waiting",
        "recomputations",
        ["asked_at", "revision", "unit_id"],
        sqlite_where=sa.text("state = 'waiting'"),
        postgresql_where=sa.text("state = 'waiting'"),
    )
    op.add_column("group_diagnoses", sa.Column("own", sa.String(), nullable=False, server_default=""))
    op.add_column("pending_groups", sa.Column("attempts", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("pending_outlooks", sa.Column("attempts", sa.Integer(), nullable=False, server_default="0"))


def downgrade() -> None:
    """The changes that recomputation made stay in the audit."""
    op.drop_column("pending_outlooks", "attempts")
    op.drop_column("pending_groups", "attempts")
    op.drop_column("group_diagnoses", "own")
    op.drop_index("ix_recomputations_waiting", "recomputations")
    op.drop_table("recomputations")
