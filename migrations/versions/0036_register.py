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
MILLISECONDS = {
    "sqlite": "(CAST(strftime('%s', substr({0}, 1, 19)) AS INTEGER) * 1000 + CAST(substr({0}, 21, 3) AS INTEGER))",
    "postgresql": "CAST(floor(extract(epoch FROM {0}) * 1000) AS BIGINT)",
}
"""Milliseconds, as in 0018; the views as in 0033, with additions at the end of each."""
ENGLISH = {
    "sqlite": "CASE instr({0}, char(31)) WHEN 0 THEN {0} ELSE substr({0}, 1, instr({0}, char(31)) - 1) END",
    "postgresql": "split_part({0}, chr(31), 1)",
}
"""A sentence without its parts."""
OF_UNITS = """
CREATE{again} VIEW health_units AS
SELECT u.serial AS unit, t.name AS unit_type, u.lot AS lot, u.simulated AS simulated,
    COALESCE(c.sessions, 0) AS sessions, s.id AS last_session, st.name AS stand,
    s.started_at AS last_at, {last_at_ms} AS last_at_ms,
    s.verdict AS verdict, c.severity AS severity, s.is_reference AS is_reference, {reason} AS reason,
    s.worst_sensor AS worst_sensor, s.worst_parameter AS worst_parameter, s.margin AS margin,
    d.state AS diagnosis, CASE WHEN d.session_id IS NOT NULL THEN COALESCE(json_array_length(d.reservations), 0) END
        AS reservations,
    COALESCE(c.flags, 0) AS flags, o.due AS due, {due_ms} AS due_ms, p.ticket IS NOT NULL AS is_undated{more}
FROM units u
JOIN unit_types t ON t.id = u.unit_type_id
LEFT JOIN conditions c ON c.unit_id = u.id
LEFT JOIN sessions s ON s.id = c.last_session
LEFT JOIN stands st ON st.id = s.stand_id
LEFT JOIN diagnoses d ON d.session_id = s.id
LEFT JOIN outlooks o ON o.unit_id = u.id
LEFT JOIN work p ON p.kind = 'outlook' AND p.key = u.serial
"""
OF_FLAGS = """
CREATE{again} VIEW health_flags AS
SELECT f.id AS id, u.serial AS unit, t.name AS unit_type, f.matter AS matter, f.place AS place, f.state AS state,
    f.severity AS severity, {summary} AS summary, f.session_id AS session,
    f.raised_at AS raised_at, {raised_at_ms} AS raised_at_ms, f.changed_at AS changed_at{more}
FROM flags f
JOIN units u ON u.id = f.unit_id
JOIN unit_types t ON t.id = u.unit_type_id
"""
MORE_OF_UNITS = ", u.owner AS owner, u.location AS location, u.custodian AS custodian, u.retired_at AS retired_at"
MORE_OF_FLAGS = ", f.scope = 'unit' AND u.retired_at IS NOT NULL AS is_of_retired"
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
    _show(MORE_OF_UNITS, MORE_OF_FLAGS)


def _show(more_of_units: str, more_of_flags: str) -> None:
    """The views again; on PostgreSQL whoever may read them still may, where columns are only added."""
    engine = op.get_context().dialect.name
    count, english = MILLISECONDS[engine].format, ENGLISH[engine].format
    keeps = engine == "postgresql" and bool(more_of_units)
    for name in () if keeps else ("health_units", "health_flags"):
        op.execute(f"DROP VIEW {name}")
    again = " OR REPLACE" if keeps else ""
    units = {"last_at_ms": count("s.started_at"), "due_ms": count("o.due"), "reason": english("s.reason")}
    op.execute(OF_UNITS.format(again=again, more=more_of_units, **units))
    flags = {"raised_at_ms": count("f.raised_at"), "summary": english("f.summary")}
    op.execute(OF_FLAGS.format(again=again, more=more_of_flags, **flags))


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
    _show("", "")
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
