"""Views with stable names for dashboards and notebooks, which read the database beside the service.

On SQLite a table cannot be rebuilt, nor on PostgreSQL a column changed, while a view reads it: a later migration that
does so drops the views before and makes them again after, with their text of then.

Revision: 0018, after 0017
"""

from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None

NAMES = ("health_units", "health_sessions", "health_history", "health_flags")
MILLISECONDS = {
    "sqlite": "(CAST(strftime('%s', substr({0}, 1, 19)) AS INTEGER) * 1000 + CAST(substr({0}, 21, 3) AS INTEGER))",
    "postgresql": "CAST(floor(extract(epoch FROM {0}) * 1000) AS BIGINT)",
}
"""Milliseconds since the start of 1970, whole; SQLite keeps times as text, UTC: 2026-03-01 09:00:00.000000."""
UNITS = """
SELECT u.serial AS unit, t.name AS unit_type, u.lot AS lot, u.simulated AS simulated,
    COALESCE(c.sessions, 0) AS sessions, s.id AS last_session, st.name AS stand,
    s.started_at AS last_at, {last_at_ms} AS last_at_ms,
    s.verdict AS verdict, c.severity AS severity, s.is_reference AS is_reference, s.reason AS reason,
    s.worst_sensor AS worst_sensor, s.worst_parameter AS worst_parameter, s.margin AS margin,
    d.state AS diagnosis, CASE WHEN d.session_id IS NOT NULL THEN COALESCE(json_array_length(d.reservations), 0) END
        AS reservations,
    COALESCE(c.flags, 0) AS flags, o.due AS due, {due_ms} AS due_ms, p.unit_id IS NOT NULL AS is_undated
FROM units u
JOIN unit_types t ON t.id = u.unit_type_id
LEFT JOIN conditions c ON c.unit_id = u.id
LEFT JOIN sessions s ON s.id = c.last_session
LEFT JOIN stands st ON st.id = s.stand_id
LEFT JOIN diagnoses d ON d.session_id = s.id
LEFT JOIN outlooks o ON o.unit_id = u.id
LEFT JOIN pending_outlooks p ON p.unit_id = u.id
"""
SESSIONS = """
SELECT s.id AS session, u.serial AS unit, t.name AS unit_type, st.name AS stand, s.block AS block,
    s.programme AS programme, s.started_at AS at, {at_ms} AS at_ms, s.uploaded_at AS uploaded_at,
    s.state AS state, s.stage AS stage, s.simulated AS simulated,
    s.verdict AS verdict, s.is_reference AS is_reference, s.reason AS reason,
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
HISTORY = """
SELECT unit, unit_type, session, at, at_ms, sensor, kind, parameter,
    value, u, value - k * u AS lower, value + k * u AS upper,
    reference, deviation, expanded, tolerance, margin, verdict, is_reference, axis_x, axis_y, axis_z, revision
FROM (
    SELECT n.serial AS unit, t.name AS unit_type, p.session_id AS session, p.at AS at, {at_ms} AS at_ms,
        p.sensor AS sensor, p.kind AS kind, p.parameter AS parameter,
        CASE WHEN p.parameter <> 'axis' OR d.session_id IS NULL THEN p.value ELSE COALESCE(d.deviation, d.value) END
            AS value,
        CASE WHEN p.parameter <> 'axis' THEN p.u ELSE COALESCE(d.uncertainty, p.u) END AS u,
        d.coverage_factor AS k, d.reference AS reference, d.deviation AS deviation, d.expanded AS expanded,
        CASE WHEN d.parameter = 'scale' THEN d.tolerance * ABS(d.reference) ELSE d.tolerance END AS tolerance,
        1 - (ABS(d.deviation) + d.expanded) / d.tolerance AS margin,
        COALESCE(d.verdict, 'undecidable') AS verdict, s.is_reference AS is_reference,
        p.axis_x AS axis_x, p.axis_y AS axis_y, p.axis_z AS axis_z, p.revision AS revision
    FROM parameters p
    JOIN sessions s ON s.id = p.session_id AND s.revision = p.revision AND s.state = 'accepted'
    JOIN units n ON n.id = p.unit_id
    JOIN unit_types t ON t.id = n.unit_type_id
    LEFT JOIN decisions d ON d.session_id = p.session_id AND d.revision = p.revision AND d.sensor = p.sensor
        AND d.parameter = p.parameter
) AS points
"""
FLAGS = """
SELECT f.id AS id, u.serial AS unit, t.name AS unit_type, f.matter AS matter, f.place AS place, f.state AS state,
    f.severity AS severity, f.summary AS summary, f.session_id AS session,
    f.raised_at AS raised_at, {raised_at_ms} AS raised_at_ms, f.changed_at AS changed_at
FROM flags f
JOIN units u ON u.id = f.unit_id
JOIN unit_types t ON t.id = u.unit_type_id
"""


def upgrade() -> None:
    """They read and hold nothing."""
    count = MILLISECONDS[op.get_context().dialect.name].format
    texts = (
        UNITS.format(last_at_ms=count("s.started_at"), due_ms=count("o.due")),
        SESSIONS.format(at_ms=count("s.started_at")),
        HISTORY.format(at_ms=count("p.at")),
        FLAGS.format(raised_at_ms=count("f.raised_at")),
    )
    for name, text in zip(NAMES, texts, strict=True):
        op.execute(f"CREATE VIEW {name} AS {text}")


def downgrade() -> None:
    """Whoever was allowed to read them must be allowed again after the next upgrade."""
    for name in NAMES:
        op.execute(f"DROP VIEW {name}")
