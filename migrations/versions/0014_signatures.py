"""Signatures under certificates with the papers as they were approved, wrong attempts to sign in, and who somebody is
elsewhere.

Revision: 0014, after 0013
"""

import sqlalchemy as sa
from alembic import op
from sqlalchemy.schema import SchemaItem

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None

APPEND_ONLY = ("certificate_signatures", "certificate_files")


def upgrade() -> None:
    """Adds tables of signatures, signed files and attempts; all are empty."""
    _of_certificates("certificate_signatures", "meaning", *_signature())
    _of_certificates("certificate_files", "format", *_file())
    for table in APPEND_ONLY:
        _make_append_only(table)
    op.create_table(
        "attempts",
        sa.Column("key", sa.String(64), nullable=False),
        sa.Column("since", _moment(), nullable=False),
        sa.Column("count", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("key", name="pk_attempts"),
    )
    _known_elsewhere()


def downgrade() -> None:
    """The audit still says who signed what."""
    for table in ("identities", "attempts", *reversed(APPEND_ONLY)):
        op.drop_table(table)


def _of_certificates(table: str, once: str, *own: SchemaItem) -> None:
    """A table of which each certificate has one row of a kind."""
    op.create_table(
        table,
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("certificate_id", sa.Integer(), nullable=False),
        *own,
        sa.PrimaryKeyConstraint("id", name=f"pk_{table}"),
        sa.ForeignKeyConstraint(["certificate_id"], ["certificates.id"], name=f"fk_{table}_certificate_id"),
        sa.UniqueConstraint("certificate_id", once, name=f"uq_{table}_certificate_id_{once}"),
    )


def _signature() -> tuple[SchemaItem, ...]:
    return (
        sa.Column("meaning", sa.String(20), nullable=False),
        sa.Column("account_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("signed_at", _moment(), nullable=False),
        sa.Column("content_hash", sa.String(64), nullable=False),
        sa.ForeignKeyConstraint(["account_id"], ["accounts.id"], name="fk_certificate_signatures_account_id"),
    )


def _file() -> tuple[SchemaItem, ...]:
    return (
        sa.Column("format", sa.String(10), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("sealed_by", sa.String(), nullable=False),
    )


def _known_elsewhere() -> None:
    op.create_table(
        "identities",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("account_id", sa.Integer(), nullable=False),
        sa.Column("issuer", sa.String(500), nullable=False),
        sa.Column("subject", sa.String(255), nullable=False),
        sa.Column("created_at", _moment(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_identities"),
        sa.ForeignKeyConstraint(["account_id"], ["accounts.id"], name="fk_identities_account_id"),
        sa.UniqueConstraint("issuer", "subject", name="uq_identities_issuer_subject"),
    )
    op.create_index("ix_identities_account_id", "identities", ["account_id"])


def _moment() -> sa.DateTime:
    return sa.DateTime(timezone=True)


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
