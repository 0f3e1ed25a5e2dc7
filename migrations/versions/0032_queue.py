"""Recomputations, jobs and messages wait in the queue too; their tables keep what became of them.

Nobody is at any of it while the schema changes, so no lease is carried over.

Revision: 0032, after 0031
"""

import sqlalchemy as sa
from alembic import op

revision = "0032"
down_revision = "0031"
branch_labels = None
depends_on = None

COLUMNS = "kind, key, asked_at, ticket, state, not_before, attempts, failed"
CARRIED = (
    "SELECT 'recomputation', u.serial || ' ' || r.revision, r.asked_at, 'r' || r.revision || '-' || r.unit_id,"
    " CASE WHEN r.state = 'waiting' THEN 'waiting' ELSE 'failed' END,"
    " CASE WHEN r.state = 'waiting' AND r.failed IS NOT NULL THEN r.claimed_until END, r.attempts,"
    " CASE WHEN r.state = 'waiting' THEN r.failed ELSE COALESCE(r.failed, 'given up') END"
    " FROM recomputations r JOIN units u ON u.id = r.unit_id WHERE r.state IN ('waiting', 'given up')"
    " ORDER BY r.asked_at, r.revision, r.unit_id",
    "SELECT CASE WHEN kind = 'upload' THEN 'upload' ELSE 'job' END, CAST(id AS VARCHAR(20)), turn_at, 'j' || id,"
    " 'waiting', CASE WHEN held_up <> '' THEN claimed_until END, attempts, NULLIF(held_up, '')"
    " FROM jobs WHERE ended_at IS NULL AND kind <> 'model' ORDER BY turn_at, id",
    "SELECT 'message', CAST(d.id AS VARCHAR(20)), n.at, 'm' || d.id, 'waiting', d.next_at, 0, NULL"
    " FROM deliveries d JOIN notices n ON n.id = d.notice_id WHERE d.state = 'waiting' ORDER BY d.id",
)
GONE = {
    "recomputations": ("asked_at", "claimed_until", "attempts", "failed"),
    "jobs": ("turn_at", "claimed_until", "attempts", "held_up"),
    "deliveries": ("next_at",),
}
LONG_AGO = "1970-01-01 00:00:00+00:00"
"""Stands in until the time is carried over."""
WORK_OF = {
    "recomputations": "(SELECT w.{0} FROM work w JOIN units u ON w.key = u.serial || ' ' || recomputations.revision"
    " WHERE w.kind = 'recomputation' AND u.id = recomputations.unit_id)",
    "jobs": "(SELECT w.{0} FROM work w WHERE w.kind IN ('job', 'upload') AND w.key = CAST(jobs.id AS VARCHAR(20)))",
    "deliveries": "(SELECT w.{0} FROM work w WHERE w.kind = 'message' AND w.key = CAST(deliveries.id AS VARCHAR(20)))",
}
BACK = {
    "recomputations": "UPDATE recomputations SET"
    " asked_at = (SELECT m.accepted_at FROM model_revisions m WHERE m.id = recomputations.revision),"
    " claimed_until = {not_before}, attempts = COALESCE({attempts}, 0), failed = {failed}",
    "jobs": "UPDATE jobs SET turn_at = COALESCE({asked_at}, asked_at), claimed_until = {not_before},"
    " attempts = COALESCE({attempts}, 0), held_up = COALESCE({failed}, '')",
    "deliveries": "UPDATE deliveries SET next_at = COALESCE(ended_at, {not_before}, {asked_at},"
    " (SELECT n.at FROM notices n WHERE n.id = deliveries.notice_id))",
}


def upgrade() -> None:
    """Carries waiting work over, with the reason for which its last try failed."""
    for query in CARRIED:
        op.execute(f"INSERT INTO work ({COLUMNS}) {query}")
    op.add_column("deliveries", sa.Column("ended_at", sa.DateTime(timezone=True), nullable=True))
    op.execute("UPDATE deliveries SET ended_at = next_at WHERE state <> 'waiting'")
    op.drop_index("ix_recomputations_waiting", "recomputations")
    op.drop_index("ix_jobs_open", "jobs")
    op.drop_index("ix_deliveries_next_at", "deliveries")
    for table, columns in GONE.items():
        for column in columns:
            op.drop_column(table, column)
    _add_index("ix_jobs_open", "jobs", ["id"], "ended_at IS NULL")
    _add_index("ix_deliveries_waiting", "deliveries", ["id"], "state = 'waiting'")


def downgrade() -> None:
    """Every record says by itself again who is at it."""
    time = sa.DateTime(timezone=True)
    for table, name in (("recomputations", "asked_at"), ("jobs", "turn_at"), ("deliveries", "next_at")):
        op.add_column(table, sa.Column(name, time, nullable=False, server_default=LONG_AGO))
    for table in ("recomputations", "jobs"):
        op.add_column(table, sa.Column("claimed_until", time, nullable=True))
        op.add_column(table, sa.Column("attempts", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("recomputations", sa.Column("failed", sa.Text(), nullable=True))
    op.add_column("jobs", sa.Column("held_up", sa.String(), nullable=False, server_default=""))
    for table, query in BACK.items():
        work = {name: WORK_OF[table].format(name) for name in ("asked_at", "not_before", "attempts", "failed")}
        op.execute(query.format(**work))
    op.execute("DELETE FROM work WHERE kind IN ('recomputation', 'job', 'upload', 'message')")
    op.drop_index("ix_jobs_open", "jobs")
    op.drop_index("ix_deliveries_waiting", "deliveries")
    op.drop_column("deliveries", "ended_at")
    _add_index("ix_recomputations_waiting", "recomputations", ["asked_at", "revision", "unit_id"], "state = 'waiting'")
    _add_index("ix_jobs_open", "jobs", ["turn_at", "id"], "ended_at IS NULL")
    _add_index("ix_deliveries_next_at", "deliveries", ["next_at"], "state = 'waiting'")


def _add_index(name: str, table: str, columns: list[str], where: str) -> None:
    condition = sa.text(where)
    op.create_index(name, table, columns, sqlite_where=condition, postgresql_where=condition)
