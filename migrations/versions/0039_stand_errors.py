"""Errors of the stand, as stated in the document of its certificate.

Certificates recorded by hand state none.

Revision: 0039, after 0038
"""

import sqlalchemy as sa
from alembic import op

revision = "0039"
down_revision = "0038"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """One column, NULL in the rows that are there."""
    op.add_column("stand_certificates", sa.Column("errors", sa.JSON(), nullable=True))


def downgrade() -> None:
    """The certificates stay."""
    op.drop_column("stand_certificates", "errors")
