"""An accepted cause can be withdrawn: a revision of its own that names the one it withdraws.

Revision: 0005, after 0004
"""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Adds the column of withdrawals; nothing is withdrawn yet."""
    op.add_column("model_revisions", sa.Column("withdraws", sa.Integer(), nullable=True))


def downgrade() -> None:
    """Deletes withdrawals, which would read as acceptances without the column."""
    op.execute(sa.text("DELETE FROM model_revisions WHERE withdraws IS NOT NULL"))
    with op.batch_alter_table("model_revisions") as table:
        table.drop_column("withdraws")
