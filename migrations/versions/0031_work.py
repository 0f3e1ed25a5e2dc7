"""Outstanding work beside the requests waits in one table: diagnoses, outlooks, groups and summaries.

The view `health_units` reads it. Nobody is at any of it while the schema changes, so no lease is carried over.

Revision: 0031, after 0030
"""

import sqlalchemy as sa
from alembic import op

revision = "0031"
down_revision = "0030"
branch_labels = None
depends_on = None

SINGLE = "kind NOT IN ('group', 'summary')"
COLUMNS = "kind, key, asked_at, ticket, state, not_before, attempts, failed"
GIVEN_UP = "CASE WHEN p.claimed_until > '9000-01-01' THEN 'failed' ELSE 'waiting' END"
"""State of older rows: those that nobody was to begin have failed."""
CARRIED = (
    "SELECT 'diagnosis', p.session_id, p.asked_at, p.ticket, 'waiting', p.not_before, p.attempts, p.failed"
    " FROM pending_diagnoses p",
    "SELECT 'outlook', u.serial, p.asked_at, p.ticket, {given_up}, NULL, p.attempts, p.failed"
    " FROM pending_outlooks p JOIN units u ON u.id = p.unit_id",
    "SELECT 'group', p.level || ' ' || p.group_id, p.asked_at, 'g' || p.id, {given_up}, NULL, p.attempts, p.failed"
    " FROM pending_groups p",
    "SELECT 'summary', p.level || ' ' || p.group_id, p.asked_at, 's' || p.id, {given_up}, NULL, p.attempts, p.failed"
    " FROM pending_summaries p",
    "SELECT 'derivation', u.serial, s.uploaded_at, 'd' || u.id, 'failed', NULL, 0, p.failed FROM failed_derivations p"
    " JOIN units u ON u.id = p.unit_id JOIN sessions s"
    " ON s.id = (SELECT min(o.id) FROM sessions o WHERE o.unit_id = u.id)",
)
NEVER = {"sqlite": "'9999-01-01 00:00:00.000000'", "postgresql": "TIMESTAMP WITH TIME ZONE '9999-01-01 00:00:00+00'"}
UNTIL = "CASE WHEN w.state = 'failed' THEN {never} ELSE w.not_before END"
BACK = (
    "INSERT INTO pending_diagnoses (session_id, asked_at, ticket, not_before, attempts, failed)"
    " SELECT key, asked_at, ticket, not_before, attempts, failed FROM work WHERE kind = 'diagnosis'",
    "INSERT INTO pending_outlooks (unit_id, asked_at, ticket, claimed_until, attempts, failed)"
    " SELECT u.id, w.asked_at, w.ticket, {until}, w.attempts, w.failed"
    " FROM work w JOIN units u ON u.serial = w.key WHERE w.kind = 'outlook'",
    "INSERT INTO failed_derivations (unit_id, failed)"
    " SELECT u.id, w.failed FROM work w JOIN units u ON u.serial = w.key WHERE w.kind = 'derivation'",
)
EACH_BACK = (
    "INSERT INTO {table} (level, group_id, asked_at, claimed_until, attempts, failed)"
    " SELECT '{level}', CAST(substr(w.key, {start}) AS INTEGER), w.asked_at, {until}, w.attempts, w.failed"
    " FROM work w WHERE w.kind = '{kind}' AND w.key LIKE '{level} %'"
)
MILLISECONDS = {
    "sqlite": "(CAST(strftime('%s', substr({0}, 1, 19)) AS INTEGER) * 1000 + CAST(substr({0}, 21, 3) AS INTEGER))",
    "postgresql": "CAST(floor(extract(epoch FROM {0}) * 1000) AS BIGINT)",
}
"""Milliseconds, as in 0018."""
UNITS = """
CREATE VIEW health_units AS
SELECT u.serial AS unit, t.name AS unit_type, u.lot AS lot, u.simulated AS simulated,
    COALESCE(c.sessions, 0) AS sessions, s.id AS last_session, st.name AS stand,
    s.started_at AS last_at, {last_at_ms} AS last_at_ms,
    s.verdict AS verdict, c.severity AS severity, s.is_reference AS is_reference, s.reason AS reason,
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
LEFT JOIN {waiting}
"""


def upgrade() -> None:
    """Carries waiting work over, with the reason for which its last try failed."""
    time, whole = sa.DateTime(timezone=True), sa.Integer()
    op.create_table(
        "work",
        sa.Column("id", whole, nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("key", sa.String(250), nullable=False),
        sa.Column("asked_at", time, nullable=False),
        sa.Column("ticket", sa.String(32), nullable=False),
        sa.Column("state", sa.String(10), nullable=False),
        sa.Column("not_before", time, nullable=True),
        sa.Column("lease_until", time, nullable=True),
        sa.Column("attempts", whole, nullable=False),
        sa.Column("failed", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_work"),
    )
    single = sa.text(SINGLE)
    op.create_index(
        "uq_work_single", "work", ["kind", "key"], unique=True, sqlite_where=single, postgresql_where=single
    )
    op.create_index("ix_work_kind_key", "work", ["kind", "key"])
    op.create_index("ix_work_kind_asked_at", "work", ["kind", "asked_at"])
    for query in CARRIED:
        op.execute(f"INSERT INTO work ({COLUMNS}) {query.format(given_up=GIVEN_UP)}")
    _rewrite_view("work p ON p.kind = 'outlook' AND p.key = u.serial")
    for table in ("failed_derivations", "pending_summaries", "pending_groups", "pending_outlooks", "pending_diagnoses"):
        op.drop_table(table)


def downgrade() -> None:
    """Every kind in a table of its own again."""
    time, whole = sa.DateTime(timezone=True), sa.Integer()
    op.create_table(
        "pending_diagnoses",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("asked_at", time, nullable=False),
        sa.Column("ticket", sa.String(32), nullable=False),
        sa.Column("not_before", time, nullable=True),
        sa.Column("claimed_by", sa.String(32), nullable=True),
        sa.Column("claimed_until", time, nullable=True),
        sa.Column("attempts", whole, nullable=False),
        sa.Column("failed", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("session_id", name="pk_pending_diagnoses"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_pending_diagnoses_session_id"),
    )
    op.create_index("ix_pending_diagnoses_asked_at", "pending_diagnoses", ["asked_at"])
    op.create_table(
        "pending_outlooks",
        sa.Column("unit_id", whole, nullable=False),
        sa.Column("asked_at", time, nullable=False),
        sa.Column("ticket", sa.String(32), nullable=False),
        sa.Column("claimed_until", time, nullable=True),
        sa.Column("attempts", whole, nullable=False),
        sa.Column("failed", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("unit_id", name="pk_pending_outlooks"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_pending_outlooks_unit_id"),
    )
    op.create_table(
        "failed_derivations",
        sa.Column("unit_id", whole, nullable=False),
        sa.Column("failed", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("unit_id", name="pk_failed_derivations"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_failed_derivations_unit_id"),
    )
    for table in ("pending_groups", "pending_summaries"):
        op.create_table(
            table,
            sa.Column("id", whole, nullable=False),
            sa.Column("level", sa.String(10), nullable=False),
            sa.Column("group_id", whole, nullable=False),
            sa.Column("asked_at", time, nullable=False),
            sa.Column("claimed_until", time, nullable=True),
            sa.Column("attempts", whole, nullable=False),
            sa.Column("failed", sa.Text(), nullable=True),
            sa.PrimaryKeyConstraint("id", name=f"pk_{table}"),
        )
        op.create_index(f"ix_{table}_level_group_id", table, ["level", "group_id"])
    _carry_back()
    _rewrite_view("pending_outlooks p ON p.unit_id = u.id")
    op.drop_table("work")


def _carry_back() -> None:
    until = UNTIL.format(never=NEVER[op.get_context().dialect.name])
    for query in BACK:
        op.execute(query.format(until=until))
    for kind, table in (("group", "pending_groups"), ("summary", "pending_summaries")):
        for level in ("unit", "type", "stand"):
            op.execute(EACH_BACK.format(until=until, table=table, kind=kind, level=level, start=len(level) + 2))


def _rewrite_view(waiting: str) -> None:
    count = MILLISECONDS[op.get_context().dialect.name].format
    op.execute("DROP VIEW health_units")
    op.execute(UNITS.format(last_at_ms=count("s.started_at"), due_ms=count("o.due"), waiting=waiting))
