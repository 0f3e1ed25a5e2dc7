"""Saved views of lists are gone: a bookmark keeps a filter.

Revision: 0041, after 0040
"""

import sqlalchemy as sa
from alembic import op

revision = "0041"
down_revision = "0040"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """The views are dropped with their table."""
    op.drop_table("saved_views")


def downgrade() -> None:
    """An empty table, as it was."""
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
