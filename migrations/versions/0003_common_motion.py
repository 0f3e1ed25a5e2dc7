"""Common motion of all sensors, residuals of each, outlooks, production lots and the longest interval of a type.

Revision: 0003, after 0002
"""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

LISTS = ("change", "change_own", "change_origin")
NUMBERS = ("common", "common_sigma", "common_p")
"""New columns of decisions; empty for those that were made before."""


def upgrade() -> None:
    """Decisions that are there keep what they were judged on: the whole change of each sensor."""
    for name in LISTS:
        op.add_column("decisions", sa.Column(name, sa.JSON(), nullable=True))
    for name in NUMBERS:
        op.add_column("decisions", sa.Column(name, sa.Double(), nullable=True))
    op.add_column("units", sa.Column("lot", sa.String(200), nullable=True))
    interval = sa.Column("maximum_interval_days", sa.Double(), nullable=False, server_default="365")
    op.add_column("unit_types", interval)
    _common_motions()
    op.create_table(
        "outlooks",
        sa.Column("unit_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("due", sa.DateTime(timezone=True), nullable=True),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("unit_id", name="pk_outlooks"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_outlooks_unit_id"),
    )


def downgrade() -> None:
    """Verdicts stay; the parts they were split into go."""
    op.drop_table("outlooks")
    op.drop_table("common_motions")
    op.drop_column("unit_types", "maximum_interval_days")
    op.drop_column("units", "lot")
    for name in (*LISTS, *NUMBERS):
        op.drop_column("decisions", name)


def _common_motions() -> None:
    op.create_table(
        "common_motions",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("revision", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("quantity", sa.String(20), nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("value", sa.JSON(), nullable=False),
        sa.Column("covariance", sa.JSON(), nullable=False),
        sa.Column("p_value", sa.Double(), nullable=True),
        sa.Column("sensors", sa.JSON(), nullable=False),
        sa.Column("left_out", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("session_id", "revision", "kind", "quantity", name="pk_common_motions"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_common_motions_session_id"),
    )
