"""Each unit's contribution to the knowledge of its type, and the temperature at which a session was measured.

Revision: 0011, after 0010
"""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Sessions stored before have no temperature here; outlooks are worked out again with the unit's next session."""
    op.add_column("sessions", sa.Column("temperature", sa.Double(), nullable=True))
    op.create_table(
        "histories",
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("parameter", sa.String(20), nullable=False),
        sa.Column("evidence", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("unit_id", "kind", "parameter", name="pk_histories"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_histories_unit_id"),
    )
    op.execute("DELETE FROM outlooks")


def downgrade() -> None:
    """Outlooks are worked out again; the knowledge that was learned is dropped."""
    op.execute("DELETE FROM outlooks")
    op.drop_table("histories")
    op.drop_column("sessions", "temperature")
