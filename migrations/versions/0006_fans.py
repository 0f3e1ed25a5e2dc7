"""The drawing data of a unit's outlook get a column of their own, apart from the data of the fleet page.

Revision: 0006, after 0005
"""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Outlooks are summaries: each is worked out again with the unit's next session."""
    op.execute("DELETE FROM outlooks")
    op.add_column("outlooks", sa.Column("drawn", sa.JSON(), nullable=False))


def downgrade() -> None:
    """Outlooks are summaries: each is worked out again with the unit's next session."""
    op.execute("DELETE FROM outlooks")
    op.drop_column("outlooks", "drawn")
