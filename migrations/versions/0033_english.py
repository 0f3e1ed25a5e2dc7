"""Views for dashboards show sentences in English, whose parts stand behind them in their columns.

Revision: 0033, after 0032
"""

from alembic import op

revision = "0033"
down_revision = "0032"
branch_labels = None
depends_on = None

MILLISECONDS = {
    "sqlite": "(CAST(strftime('%s', substr({0}, 1, 19)) AS INTEGER) * 1000 + CAST(substr({0}, 21, 3) AS INTEGER))",
    "postgresql": "CAST(floor(extract(epoch FROM {0}) * 1000) AS BIGINT)",
}
"""Milliseconds, as in 0018."""
ENGLISH = {
    "sqlite": "CASE instr({0}, char(31)) WHEN 0 THEN {0} ELSE substr({0}, 1, instr({0}, char(31)) - 1) END",
    "postgresql": "split_part({0}, chr(31), 1)",
}
"""A sentence without its parts."""
SENTENCES = (
    ("sessions", "reason"),
    ("calibrations", "reason"),
    ("diagnoses", "summary"),
    ("flags", "summary"),
    ("flags", "proposal"),
    ("session_statistics", "why"),
    ("group_diagnoses", "summary"),
    ("group_diagnoses", "own"),
    ("outlooks", "reason"),
    ("work", "failed"),
)
"""Columns of sentences."""
APPEND_ONLY = (("record_states", "why"), ("reference_choices", "why"), ("notices", "text"))
"""Columns of sentences in tables whose lines nobody may change; only this change of the schema may."""
UNITS = """
CREATE VIEW health_units AS
SELECT u.serial AS unit, t.name AS unit_type, u.lot AS lot, u.simulated AS simulated,
    COALESCE(c.sessions, 0) AS sessions, s.id AS last_session, st.name AS stand,
    s.started_at AS last_at, {last_at_ms} AS last_at_ms,
    s.verdict AS verdict, c.severity AS severity, s.is_reference AS is_reference, {reason} AS reason,
    s.worst_sensor AS worst_sensor, s.worst_parameter AS worst_parameter, s.margin AS margin,
    d.state AS diagnosis, CASE WHEN d.session_id IS NOT NULL THEN COALESCE(json_array_length(d.reservations), 0) END
        AS reservations,
    COALESCE(c.flags, 0) AS flags, o.due AS due, {due_ms} AS due_ms, p.ticket IS NOT NULL AS is_undated
FROM units u
JOIN unit_types t ON t.id = u.unit_type_id
LEFT JOIN conditions c ON c.unit_id = u.id
LEFT JOIN sessions s ON s.id = c.last_session
LEFT JOIN stands st ON st.id = s.stand_id
LEFT JOIN diagnoses d ON d.session_id = s.id
LEFT JOIN outlooks o ON o.unit_id = u.id
LEFT JOIN work p ON p.kind = 'outlook' AND p.key = u.serial
"""
SESSIONS = """
CREATE VIEW health_sessions AS
SELECT s.id AS session, u.serial AS unit, t.name AS unit_type, st.name AS stand, s.block AS block,
    s.programme AS programme, s.started_at AS at, {at_ms} AS at_ms, s.uploaded_at AS uploaded_at,
    s.state AS state, s.stage AS stage, s.simulated AS simulated,
    s.verdict AS verdict, s.is_reference AS is_reference, {reason} AS reason,
    s.worst_sensor AS worst_sensor, s.worst_parameter AS worst_parameter, s.margin AS margin,
    d.state AS diagnosis, CASE WHEN d.session_id IS NOT NULL THEN COALESCE(json_array_length(d.reservations), 0) END
        AS reservations,
    s.revision AS revision
FROM sessions s
JOIN units u ON u.id = s.unit_id
JOIN unit_types t ON t.id = u.unit_type_id
LEFT JOIN stands st ON st.id = s.stand_id
LEFT JOIN diagnoses d ON d.session_id = s.id
"""
FLAGS = """
CREATE VIEW health_flags AS
SELECT f.id AS id, u.serial AS unit, t.name AS unit_type, f.matter AS matter, f.place AS place, f.state AS state,
    f.severity AS severity, {summary} AS summary, f.session_id AS session,
    f.raised_at AS raised_at, {raised_at_ms} AS raised_at_ms, f.changed_at AS changed_at
FROM flags f
JOIN units u ON u.id = f.unit_id
JOIN unit_types t ON t.id = u.unit_type_id
"""


def upgrade() -> None:
    """Whoever was allowed to read the views must be allowed again."""
    _rewrite(ENGLISH[op.get_context().dialect.name])


def downgrade() -> None:
    """Sentences stay in English: what was there before knows nothing of parts."""
    english = ENGLISH[op.get_context().dialect.name]
    for table, column in SENTENCES:
        _shorten(table, column, english)
    for table, column in APPEND_ONLY:
        _unlock(table)
        _shorten(table, column, english)
        _lock(table)
    _rewrite("{0}")


def _shorten(table: str, column: str, english: str) -> None:
    op.execute(f"UPDATE {table} SET {column} = {english.format(column)}")  # noqa: S608 - our own tables


def _unlock(table: str) -> None:
    if op.get_context().dialect.name == "postgresql":
        op.execute(f"ALTER TABLE {table} DISABLE TRIGGER {table}_append_only")
    else:
        op.execute(f"DROP TRIGGER {table}_no_update")


def _lock(table: str) -> None:
    if op.get_context().dialect.name == "postgresql":
        op.execute(f"ALTER TABLE {table} ENABLE TRIGGER {table}_append_only")
    else:
        op.execute(
            f"CREATE TRIGGER {table}_no_update BEFORE UPDATE ON {table} "
            f"BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END"
        )


def _rewrite(english: str) -> None:
    count = MILLISECONDS[op.get_context().dialect.name].format
    for name in ("health_units", "health_sessions", "health_flags"):
        op.execute(f"DROP VIEW {name}")
    reason, summary = english.format("s.reason"), english.format("f.summary")
    op.execute(UNITS.format(last_at_ms=count("s.started_at"), due_ms=count("o.due"), reason=reason))
    op.execute(SESSIONS.format(at_ms=count("s.started_at"), reason=reason))
    op.execute(FLAGS.format(raised_at_ms=count("f.raised_at"), summary=summary))
