"""The answer to whether a unit may be used is kept, so that lists and counts lead with it.

Revision: 0042, after 0041
"""

import sqlalchemy as sa
from alembic import op

revision = "0042"
down_revision = "0041"
branch_labels = None
depends_on = None


MILLISECONDS = {
    "sqlite": "(CAST(strftime('%s', substr({0}, 1, 19)) AS INTEGER) * 1000 + CAST(substr({0}, 21, 3) AS INTEGER))",
    "postgresql": "CAST(floor(extract(epoch FROM {0}) * 1000) AS BIGINT)",
}
REASON = {
    "sqlite": "CASE instr({0}, char(31)) WHEN 0 THEN {0} ELSE substr({0}, 1, instr({0}, char(31)) - 1) END",
    "postgresql": "split_part({0}, chr(31), 1)",
}
"""A sentence without its parts."""
WORDS = {
    "sqlite": {"true": "1", "false": "0", "tomorrow": "datetime('now', '+1 day')"},
    "postgresql": {"true": "true", "false": "false", "tomorrow": "CURRENT_TIMESTAMP + INTERVAL '1 day'"},
}
"""Terms that each engine writes in its own way."""
UNITS = """
CREATE {or_replace}VIEW health_units AS
SELECT u.serial AS unit, t.name AS unit_type, u.lot AS lot, u.simulated AS simulated,
    COALESCE(c.sessions, 0) AS sessions, s.id AS last_session, st.name AS stand,
    s.started_at AS last_at, {last_at_ms} AS last_at_ms,
    s.verdict AS verdict, c.severity AS severity, s.is_reference AS is_reference, {reason} AS reason,
    s.worst_sensor AS worst_sensor, s.worst_parameter AS worst_parameter, s.margin AS margin,
    d.state AS diagnosis, CASE WHEN d.session_id IS NOT NULL THEN COALESCE(json_array_length(d.reservations), 0) END
        AS reservations,
    COALESCE(c.flags, 0) AS flags, o.due AS due, {due_ms} AS due_ms, p.ticket IS NOT NULL AS is_undated,
    u.owner AS owner, u.location AS location, u.custodian AS custodian, u.retired_at AS retired_at{more}
FROM units u
JOIN unit_types t ON t.id = u.unit_type_id
LEFT JOIN conditions c ON c.unit_id = u.id
LEFT JOIN sessions s ON s.id = c.last_session
LEFT JOIN stands st ON st.id = s.stand_id
LEFT JOIN diagnoses d ON d.session_id = s.id
LEFT JOIN outlooks o ON o.unit_id = u.id
LEFT JOIN work p ON p.kind = 'outlook' AND p.key = u.serial{join}
"""
MORE = """,
    COALESCE(x.answer IN ('yes', 'with-reservation') AND COALESCE(o.due >= CURRENT_TIMESTAMP, {true})
        AND s.started_at <= {tomorrow}, {false}) AS usable,
    CASE WHEN x.answer NOT IN ('yes', 'with-reservation') THEN x."use"
        WHEN s.started_at > {tomorrow} THEN 'Do not use: put the date of its session right'
        WHEN o.due < CURRENT_TIMESTAMP THEN 'Do not use: calibrate it'
        ELSE COALESCE(x."use", 'Do not use yet') END AS "use"
"""
JOIN = """
LEFT JOIN uses x ON x.unit_id = u.id"""


def upgrade() -> None:
    """The table is filled at the next start, and with every change of a unit's records; the view of units shows it."""
    op.create_table(
        "uses",
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("answer", sa.String(20), nullable=False),
        sa.Column("rank", sa.Integer(), nullable=False),
        sa.Column("is_listed", sa.Boolean(), nullable=False),
        sa.Column("use", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("unit_id", name="pk_uses"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_uses_unit_id"),
    )
    op.create_index("ix_uses_answer", "uses", ["answer"])
    _view(MORE.format(**WORDS[op.get_context().dialect.name]), JOIN, replaces=True)


def downgrade() -> None:
    """It can be made again; whoever was allowed to read the view must be allowed again."""
    _view("", "", replaces=False)
    op.drop_table("uses")


def _view(more: str, join: str, *, replaces: bool) -> None:
    """PostgreSQL adds columns to a view that stands, with whoever may read it; else it is made anew."""
    engine = op.get_context().dialect.name
    keeps = replaces and engine == "postgresql"
    if not keeps:
        op.execute("DROP VIEW health_units")
    count, reason = MILLISECONDS[engine].format, REASON[engine].format("s.reason")
    parts = {"last_at_ms": count("s.started_at"), "due_ms": count("o.due"), "reason": reason}
    op.execute(UNITS.format(or_replace="OR REPLACE " if keeps else "", more=more, join=join, **parts))
