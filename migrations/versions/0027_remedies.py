"""Remedies for a questioned session are kept with the line of its life that questions it.

Its page read the file and the unit's reference anew each time. Lines from before keep none, and their pages still do.

Revision: 0027, after 0026
"""

import sqlalchemy as sa
from alembic import op

revision = "0027"
down_revision = "0026"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One document, of what is known then."""
    op.add_column("record_states", sa.Column("remedies", sa.JSON(none_as_null=True), nullable=True))


def downgrade() -> None:
    """It is asked of the file again."""
    op.drop_column("record_states", "remedies")
