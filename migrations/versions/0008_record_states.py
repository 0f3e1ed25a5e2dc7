"""Sessions and services have states, sessions a digest of their content, and references can be chosen.

Revision: 0008, after 0007
"""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

APPEND_ONLY = ("record_states", "reference_choices")
INDEXED = ("content_digest", "basis")
"""Columns of sessions."""


def upgrade() -> None:
    """Every record is accepted, as it was until now, and keeps its verdict until a change touches its unit."""
    for table, column in (
        ("sessions", _state()),
        ("sessions", sa.Column("superseded_by", sa.String(20), nullable=True)),
        ("sessions", sa.Column("content_digest", sa.String(64), nullable=True)),
        ("sessions", sa.Column("basis", sa.String(160), nullable=True)),
        ("sessions", sa.Column("tells", sa.JSON(), nullable=True)),
        ("services", _state()),
        ("diagnoses", sa.Column("tells", sa.JSON(), nullable=True)),
    ):
        op.add_column(table, column)
    for column in INDEXED:
        op.create_index(f"ix_sessions_{column}", "sessions", [column])
    _record_states()
    _reference_choices()
    for name in APPEND_ONLY:
        _make_append_only(name)


def downgrade() -> None:
    """Drops the states; every stored record counts again."""
    for name in APPEND_ONLY:
        op.drop_table(name)
    op.drop_column("diagnoses", "tells")
    op.drop_column("services", "state")
    for name in INDEXED:
        op.drop_index(f"ix_sessions_{name}", "sessions")
    for name in ("tells", "basis", "content_digest", "superseded_by", "state"):
        op.drop_column("sessions", name)


def _state() -> sa.Column[str]:
    return sa.Column("state", sa.String(20), nullable=False, server_default="accepted")


def _record_states() -> None:
    op.create_table(
        "record_states",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("record", sa.String(20), nullable=False),
        sa.Column("state", sa.String(20), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("why", sa.String(), nullable=False),
        sa.Column("superseded_by", sa.String(20), nullable=True),
        sa.PrimaryKeyConstraint("id", name="pk_record_states"),
    )
    op.create_index("ix_record_states_record", "record_states", ["kind", "record", "id"])


def _reference_choices() -> None:
    op.create_table(
        "reference_choices",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("why", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_reference_choices"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_reference_choices_unit_id"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_reference_choices_session_id"),
    )
    op.create_index("ix_reference_choices_unit_id", "reference_choices", ["unit_id"])


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
