"""Diagnoses, accepted causes as numbered model revisions, and results that belong to a revision.

Revision: 0002, after 0001
"""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

PARAMETER_KEY = ["session_id", "revision", "sensor", "parameter"]
KEYS = {
    "calibrations": ["session_id", "revision"],
    "parameters": PARAMETER_KEY,
    "decisions": PARAMETER_KEY,
}
"""Primary keys, with the revision that is new in them."""
VERDICT = ("verdict", "reason", "worst_sensor", "worst_parameter", "margin")
"""Columns of the verdict that a calibration led to; until now only the session stored it."""


def upgrade() -> None:
    """Adds the revision of the model to everything stored, which was computed under the baseline model: revision 0."""
    for table in ("sessions", *KEYS):
        op.add_column(table, sa.Column("revision", sa.Integer(), nullable=False, server_default="0"))
    for table, key in KEYS.items():
        _key(table, key)
    _verdict_of_calibrations()
    _models()
    _diagnoses()


def downgrade() -> None:
    """Each session keeps its first calibration and the verdict that it led to."""
    op.drop_table("diagnoses")
    op.drop_table("model_revisions")
    _first_only()
    for column in (*VERDICT, "computed_at"):
        op.drop_column("calibrations", column)
    for table, key in KEYS.items():
        _key(table, [column for column in key if column != "revision"])
        op.drop_column(table, "revision")
    op.drop_column("sessions", "revision")


def _key(table: str, columns: Sequence[str]) -> None:
    """Another primary key; SQLite copies the table for it, PostgreSQL changes it in place."""
    name = f"pk_{table}"
    with op.batch_alter_table(table) as altered:
        altered.drop_constraint(name, type_="primary")
        altered.create_primary_key(name, list(columns))


def _verdict_of_calibrations() -> None:
    op.add_column("calibrations", sa.Column("computed_at", sa.DateTime(timezone=True)))
    op.add_column("calibrations", sa.Column("verdict", sa.String(20)))
    op.add_column("calibrations", sa.Column("reason", sa.String()))
    op.add_column("calibrations", sa.Column("worst_sensor", sa.String()))
    op.add_column("calibrations", sa.Column("worst_parameter", sa.String(20)))
    op.add_column("calibrations", sa.Column("margin", sa.Double()))
    sessions, calibrations = (sa.table(t, *map(sa.column, _columns(t))) for t in ("sessions", "calibrations"))
    own = sessions.c.id == calibrations.c.session_id
    told = {name: sa.select(sessions.c[name]).where(own).scalar_subquery() for name in VERDICT}
    uploaded = sa.select(sessions.c.uploaded_at).where(own).scalar_subquery()
    op.execute(calibrations.update().values(**told, computed_at=uploaded))
    with op.batch_alter_table("calibrations") as altered:
        for name in ("computed_at", "verdict", "reason"):
            altered.alter_column(name, nullable=False)


def _columns(table: str) -> tuple[str, ...]:
    return ("id", "uploaded_at", *VERDICT) if table == "sessions" else ("session_id", "computed_at", *VERDICT)


def _first_only() -> None:
    """Later calibrations go, and the sessions' verdicts are those of the first again."""
    for table in KEYS:
        rows = sa.table(table, sa.column("session_id"), sa.column("revision"))
        first = rows.alias("first")
        lowest = sa.select(sa.func.min(first.c.revision)).where(first.c.session_id == rows.c.session_id)
        op.execute(rows.delete().where(rows.c.revision > lowest.scalar_subquery()))
    sessions, calibrations = (sa.table(t, *map(sa.column, _columns(t))) for t in ("sessions", "calibrations"))
    own = sessions.c.id == calibrations.c.session_id
    op.execute(
        sessions.update().values(**{n: sa.select(calibrations.c[n]).where(own).scalar_subquery() for n in VERDICT})
    )


def _models() -> None:
    op.create_table(
        "model_revisions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("scope", sa.String(20), nullable=False),
        sa.Column("subject", sa.String(200), nullable=False),
        sa.Column("cause", sa.String(60), nullable=False),
        sa.Column("sensors", sa.JSON(), nullable=False),
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("evidence", sa.JSON(), nullable=False),
        sa.Column("accepted_by", sa.String(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("accepted_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_model_revisions"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_model_revisions_session_id"),
    )
    op.create_index("ix_model_revisions_session_id", "model_revisions", ["session_id"])
    op.create_index("ix_model_revisions_scope", "model_revisions", ["scope", "subject", "id"])


def _diagnoses() -> None:
    op.create_table(
        "diagnoses",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("model_revision", sa.Integer(), nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("summary", sa.String(), nullable=False),
        sa.Column("document", sa.LargeBinary(), nullable=True),
        sa.Column("verdict_after", sa.String(20), nullable=True),
        sa.Column("estimator_version", sa.String(40), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("session_id", name="pk_diagnoses"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_diagnoses_session_id"),
    )
