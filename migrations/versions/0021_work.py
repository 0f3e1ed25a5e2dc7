"""Assignees of flags, and views of lists that people keep.

Revision: 0021, after 0019
"""

import sqlalchemy as sa
from alembic import op

revision = "0021"
down_revision = "0019"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """No flag is anybody's yet."""
    op.add_column("flags", sa.Column("assignee", sa.String(200), nullable=False, server_default=""))
    op.add_column("flags", sa.Column("assignee_login", sa.String(60), nullable=False, server_default=""))
    op.create_table(
        "saved_views",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("page", sa.String(20), nullable=False),
        sa.Column("name", sa.String(100), nullable=False),
        sa.Column("owner", sa.String(60), nullable=False),
        sa.Column("query", sa.String(), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("saved_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_saved_views"),
        sa.UniqueConstraint("page", "owner", "name", name="uq_saved_views_page_owner_name"),
    )


def downgrade() -> None:
    """Former assignees of a flag stay in its life."""
    op.drop_table("saved_views")
    op.drop_column("flags", "assignee_login")
    op.drop_column("flags", "assignee")
