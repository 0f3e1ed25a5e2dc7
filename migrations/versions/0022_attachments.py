"""Remarks on sessions, files attached to units and sessions, and calibrations that are checks.

Revision: 0022, after 0021
"""

import sqlalchemy as sa
from alembic import op

revision = "0022"
down_revision = "0021"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Adds attachments and checks; nothing is attached yet, and no session is a check."""
    op.add_column("notes", sa.Column("session_id", sa.String(20), nullable=True))
    op.create_index("ix_notes_session_id", "notes", ["session_id"])
    op.add_column("sessions", sa.Column("is_check", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.create_table(
        "attachments",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("session_id", sa.String(20), nullable=True),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("filename", sa.String(), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("text", sa.String(), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_attachments"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_attachments_unit_id"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_attachments_session_id"),
    )
    op.create_index("ix_attachments_unit_id", "attachments", ["unit_id"])
    op.create_index("ix_attachments_session_id", "attachments", ["session_id"])
    op.create_table(
        "attachment_withdrawals",
        sa.Column("attachment_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("why", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("attachment_id", name="pk_attachment_withdrawals"),
        sa.ForeignKeyConstraint(["attachment_id"], ["attachments.id"], name="fk_attachment_withdrawals_attachment_id"),
    )
    for table in ("attachments", "attachment_withdrawals"):
        _make_append_only(table)


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
    """Attached files stay where they lie, without their names; remarks on sessions stay as those on their units."""
    op.drop_table("attachment_withdrawals")
    op.drop_table("attachments")
    op.drop_column("sessions", "is_check")
    op.drop_index("ix_notes_session_id", "notes")
    op.drop_column("notes", "session_id")
