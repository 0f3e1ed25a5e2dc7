"""Names on certificates: the customer of a unit, the certificates of stands, and the numbers of those issued.

Revision: 0009, after 0008
"""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

APPEND_ONLY = ("stand_certificates", "certificates")


def upgrade() -> None:
    """No customer is known yet, no stand has a certificate, and no certificate was numbered."""
    op.add_column("units", sa.Column("customer", sa.String(200), nullable=False, server_default=""))
    op.add_column("units", sa.Column("customer_address", sa.String(2000), nullable=False, server_default=""))
    _stand_certificates()
    _certificates()
    for table in APPEND_ONLY:
        _make_append_only(table)


def downgrade() -> None:
    """The audit still says what was recorded."""
    for table in reversed(APPEND_ONLY):
        op.drop_table(table)
    op.drop_column("units", "customer_address")
    op.drop_column("units", "customer")


def _stand_certificates() -> None:
    op.create_table(
        "stand_certificates",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("stand_id", sa.Integer(), nullable=False),
        sa.Column("number", sa.String(200), nullable=False),
        sa.Column("issued_by", sa.String(200), nullable=False),
        sa.Column("issued_on", sa.Date(), nullable=False),
        sa.Column("valid_until", sa.Date(), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("recorded_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_stand_certificates"),
        sa.ForeignKeyConstraint(["stand_id"], ["stands.id"], name="fk_stand_certificates_stand_id"),
    )
    op.create_index("ix_stand_certificates_stand_id", "stand_certificates", ["stand_id"])


def _certificates() -> None:
    op.create_table(
        "certificates",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("number", sa.String(60), nullable=False),
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("issued_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("replaces", sa.String(60), nullable=True),
        sa.Column("content_hash", sa.String(64), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_certificates"),
        sa.UniqueConstraint("number", name="uq_certificates_number"),
        sa.ForeignKeyConstraint(["session_id"], ["sessions.id"], name="fk_certificates_session_id"),
    )
    op.create_index("ix_certificates_session_id", "certificates", ["session_id"])


def _make_append_only(table: str) -> None:
    """The database itself refuses to change or delete a line."""
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
