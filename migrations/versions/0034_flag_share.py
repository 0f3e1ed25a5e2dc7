"""Each unit type says from which part of the tolerance on a change within it has a flag.

Revision: 0034, after 0033
"""

import sqlalchemy as sa
from alembic import op

revision = "0034"
down_revision = "0033"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Types that are there have what new ones have."""
    share = sa.Column("flag_share", sa.Double(), nullable=False, server_default="0.3")
    op.add_column("unit_types", share)


def downgrade() -> None:
    """Every change that was found had a flag."""
    op.drop_column("unit_types", "flag_share")
