"""Tolerances that somebody entered are distinguished from the defaults that a type begins with, and may judge the
sessions that were stored before them.

Revision: 0046, after 0045
"""

import sqlalchemy as sa
from alembic import op

revision = "0046"
down_revision = "0045"
branch_labels = None
depends_on = None

TABLE = sa.table(
    "tolerance_revisions",
    sa.column("unit_type_id", sa.Integer),
    sa.column("revision", sa.Integer),
    sa.column("tolerances", sa.JSON),
    sa.column("gyro_tolerances", sa.JSON),
    sa.column("are_entered", sa.Boolean),
)


def upgrade() -> None:
    """Marks tolerances as entered from the first that differ from those that their type began with."""
    op.add_column(
        "tolerance_revisions", sa.Column("are_entered", sa.Boolean(), nullable=False, server_default=sa.false())
    )
    op.add_column(
        "tolerance_revisions", sa.Column("holds_before", sa.Boolean(), nullable=False, server_default=sa.false())
    )
    connection, first, entered = op.get_bind(), {}, set()
    numbers = TABLE.c.unit_type_id, TABLE.c.revision
    query = sa.select(*numbers, TABLE.c.tolerances, TABLE.c.gyro_tolerances).order_by(*numbers)
    for of_type, number, *tolerances in connection.execute(query).all():
        if first.setdefault(of_type, tolerances) != tolerances:
            entered.add(of_type)
        if of_type in entered:
            row = (TABLE.c.unit_type_id == of_type) & (TABLE.c.revision == number)
            connection.execute(TABLE.update().where(row).values(are_entered=True))


def downgrade() -> None:
    """Nothing tells them apart."""
    op.drop_column("tolerance_revisions", "holds_before")
    op.drop_column("tolerance_revisions", "are_entered")
