"""Adds the remembered layouts of people's own tables.

Revision: 0015, after 0014
"""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Adds the table of layouts, which is empty."""
    op.create_table(
        "layouts",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("fingerprint", sa.String(64), nullable=False),
        sa.Column("unit_type", sa.String(200), nullable=False),
        sa.Column("mapping", sa.JSON(), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("remembered_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_layouts"),
    )
    op.create_index("ix_layouts_fingerprint", "layouts", ["fingerprint"])


def downgrade() -> None:
    """Layouts are asked again."""
    op.drop_index("ix_layouts_fingerprint", "layouts")
    op.drop_table("layouts")
