"""The correction of a change for the temperature of its session.

Sessions judged by earlier releases had none.

Revision: 0037, after 0036
"""

import sqlalchemy as sa
from alembic import op

revision = "0037"
down_revision = "0036"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One column, NULL in the rows that are there."""
    op.add_column("decisions", sa.Column("temperature_correction", sa.JSON(), nullable=True))


def downgrade() -> None:
    """The verdicts stay; judged again, a session is judged at its own temperature."""
    op.drop_column("decisions", "temperature_correction")
