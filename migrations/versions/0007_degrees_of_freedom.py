"""A decision keeps the degrees of freedom that its uncertainty rests on.

Revision: 0007, after 0006
"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Decisions made before took the noise for known, which is what null says."""
    op.add_column("decisions", sa.Column("dof", sa.Double(), nullable=True))


def downgrade() -> None:
    """The coverage factor stays with each decision."""
    with op.batch_alter_table("decisions") as table:
        table.drop_column("dof")
