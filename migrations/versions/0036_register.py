"""The register: whose a unit is, where it is and who has it, with its history; retired units.

Revision: 0036, after 0035
"""

import sqlalchemy as sa
from alembic import op

revision = "0036"
down_revision = "0035"
branch_labels = None
depends_on = None

TEXTS = {"owner": 200, "location": 200, "custodian": 200, "remark": 2000}
TIMES = ("registered_at", "retired_at")
UNITS = sa.table("units", sa.column("id"), sa.column("unit_type_id"))
TYPES = sa.table("unit_types", sa.column("id"), sa.column("block"))
TALLIED = sa.table("tallied", sa.column("unit_id"), sa.column("severity"))
OF_TYPES = tuple(sa.table(name, sa.column("unit_type_id")) for name in ("tolerance_revisions", "fleet_tallies"))
MENTIONING = tuple(
    sa.table(name, sa.column("unit_id")) for name in ("sessions", "notes", "attachments", "services", "flags")
)
TALLIES = sa.table("fleet_tallies", sa.column("severity"))
COUNTED_APART = (-3, -2)
"""Severities of retired units, and of registered ones without a session."""


def upgrade() -> None:
    """Units that are there came with their first session; nothing more is known of them."""
    for name, length in TEXTS.items():
        op.add_column("units", sa.Column(name, sa.String(length), nullable=False, server_default=""))
    for name in TIMES:
        op.add_column("units", sa.Column(name, sa.DateTime(timezone=True), nullable=True))
    op.create_table(
        "custody",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("recorded_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("who", sa.String(200), nullable=False),
        sa.Column("step", sa.String(20), nullable=False),
        sa.Column("location_before", sa.String(200), nullable=False),
        sa.Column("location", sa.String(200), nullable=False),
        sa.Column("custodian_before", sa.String(200), nullable=False),
        sa.Column("custodian", sa.String(200), nullable=False),
        sa.Column("remark", sa.String(2000), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_custody"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_custody_unit_id"),
    )
    op.create_index("ix_custody_unit_id", "custody", ["unit_id"])
    _make_append_only("custody")


def _make_append_only(table: str) -> None:
    """The database itself refuses to change or delete a line; on PostgreSQL by the function that revision 0004 made."""
    if op.get_bind().dialect.name == "postgresql":
        op.execute(
            f"CREATE TRIGGER {table}_append_only BEFORE UPDATE OR DELETE OR TRUNCATE ON {table} "
            "FOR EACH STATEMENT EXECUTE FUNCTION line_is_append_only()"
        )
        return
    for action in ("UPDATE", "DELETE"):
        op.execute(
            f"CREATE TRIGGER {table}_no_{action.lower()} BEFORE {action} ON {table} "
            f"BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END"
        )


def downgrade() -> None:
    """Units without a session go, with types of which only the name is known, unless notes or files are kept of them.
    Retired units are in use again; they are counted with their next session."""
    op.drop_table("custody")
    mentioned = [sa.exists().where(table.c.unit_id == UNITS.c.id) for table in MENTIONING]
    going = op.get_bind().scalars(sa.select(UNITS.c.id).where(*(~one for one in mentioned))).all()
    for column in (TALLIED.c.unit_id, UNITS.c.id):
        op.execute(sa.delete(column.table).where(column.in_(going)))
    has_unit = sa.exists().where(UNITS.c.unit_type_id == TYPES.c.id)
    types = op.get_bind().scalars(sa.select(TYPES.c.id).where(TYPES.c.block == "", ~has_unit)).all()
    for column in (*(table.c.unit_type_id for table in OF_TYPES), TYPES.c.id):
        op.execute(sa.delete(column.table).where(column.in_(types)))
    for counts in (TALLIED, TALLIES):
        op.execute(sa.delete(counts).where(counts.c.severity.in_(COUNTED_APART)))
    for name in (*TIMES, *TEXTS):
        op.drop_column("units", name)
