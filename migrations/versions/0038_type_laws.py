"""Common temperature laws of a type's units, with each revision of its tolerances.

Types that are there have none yet.

Revision: 0038, after 0037
"""

import sqlalchemy as sa
from alembic import op

revision = "0038"
down_revision = "0037"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One column, NULL in the rows that are there."""
    op.add_column("tolerance_revisions", sa.Column("temperature_laws", sa.JSON(), nullable=True))


def downgrade() -> None:
    """The verdicts stay; judged again, a session is judged by the law of its unit alone."""
    op.drop_column("tolerance_revisions", "temperature_laws")
