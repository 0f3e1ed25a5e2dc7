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
    """Nothing is withdrawn yet."""
    op.add_column("model_revisions", sa.Column("withdraws", sa.Integer(), nullable=True))


def downgrade() -> None:
    """Without the column a withdrawal would read as an acceptance: it goes."""
    op.execute(sa.text("DELETE FROM model_revisions WHERE withdraws IS NOT NULL"))
    with op.batch_alter_table("model_revisions") as table:
        table.drop_column("withdraws")
