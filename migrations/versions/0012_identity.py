"""Accounts, tokens, signed-in browsers and links; every line of the audit names the account and the line before it.

Revision: 0012, after 0011
"""

import json
from datetime import UTC
from hashlib import sha256

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None

AUDIT = sa.table(
    "audit",
    *(sa.column(name) for name in ("id", "who", "action", "subject", "hash")),
    sa.column("at", sa.DateTime(timezone=True)),
    sa.column("details", sa.JSON()),
)
FIRST = "0" * 64
"""Hash before the first line."""


def upgrade() -> None:
    """Lines of the audit that were written before are chained as they stand."""
    _accounts()
    op.add_column("audit", sa.Column("account", sa.String(260), nullable=False, server_default=""))
    op.add_column("audit", sa.Column("hash", sa.String(64), nullable=False, server_default=""))
    _unguard()
    _chain()
    _guard()


def downgrade() -> None:
    """The audit stays, without its chain; nobody can sign in any more."""
    _unguard()
    op.drop_column("audit", "hash")
    op.drop_column("audit", "account")
    _guard()
    for table in ("sign_in_links", "sign_ins", "tokens", "accounts"):
        op.drop_table(table)


def _accounts() -> None:
    op.create_table(
        "accounts",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("login", sa.String(60), nullable=False),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("role", sa.String(20), nullable=False),
        sa.Column("password_hash", sa.String(200), nullable=True),
        sa.Column("is_active", sa.Boolean(), nullable=False),
        sa.Column("created_at", _moment(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_accounts"),
        sa.UniqueConstraint("login", name="uq_accounts_login"),
    )
    _owned("tokens", *_of_tokens())
    _owned("sign_ins")
    _owned("sign_in_links", sa.Column("used_at", _moment(), nullable=True), nobody=True)


def _of_tokens() -> tuple[sa.Column, ...]:
    return (
        sa.Column("label", sa.String(200), nullable=False),
        sa.Column("role", sa.String(20), nullable=False),
        sa.Column("revoked_at", _moment(), nullable=True),
        sa.Column("last_used_at", _moment(), nullable=True),
    )


def _owned(table: str, *own: sa.Column, nobody: bool = False) -> None:
    """A table of secrets, each of an account, or of nobody yet."""
    op.create_table(
        table,
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("account_id", sa.Integer(), nullable=nobody),
        sa.Column("hash", sa.String(64), nullable=False),
        sa.Column("created_at", _moment(), nullable=False),
        sa.Column("expires_at", _moment(), nullable=False),
        *own,
        sa.PrimaryKeyConstraint("id", name=f"pk_{table}"),
        sa.UniqueConstraint("hash", name=f"uq_{table}_hash"),
        sa.ForeignKeyConstraint(["account_id"], ["accounts.id"], name=f"fk_{table}_account_id"),
    )
    op.create_index(f"ix_{table}_account_id", table, ["account_id"])


def _moment() -> sa.DateTime:
    return sa.DateTime(timezone=True)


def _chain() -> None:
    """Chains the lines as `service.storage.audit` does, written out: a migration must not change when the program
    does.
    """
    connection, last = op.get_bind(), FIRST
    for row in connection.execute(sa.select(AUDIT).order_by(AUDIT.c.id)).all():
        at = row.at.replace(tzinfo=UTC) if row.at.tzinfo is None else row.at.astimezone(UTC)
        line = [last, at.isoformat(timespec="microseconds"), row.who, "", row.action, row.subject, row.details]
        last = sha256(json.dumps(line, sort_keys=True, ensure_ascii=False).encode()).hexdigest()
        connection.execute(sa.update(AUDIT).where(AUDIT.c.id == row.id).values(hash=last))


def _unguard() -> None:
    """The audit can be changed; nobody else sees it so, for the migration is one transaction."""
    if op.get_bind().dialect.name == "postgresql":
        op.execute("DROP TRIGGER audit_append_only ON audit")
        return
    for action in ("UPDATE", "DELETE"):
        op.execute(f"DROP TRIGGER audit_no_{action.lower()}")


def _guard() -> None:
    """The audit is append-only again."""
    if op.get_bind().dialect.name == "postgresql":
        op.execute(
            "CREATE TRIGGER audit_append_only BEFORE UPDATE OR DELETE OR TRUNCATE ON audit "
            "FOR EACH STATEMENT EXECUTE FUNCTION audit_is_append_only()"
        )
        return
    for action in ("UPDATE", "DELETE"):
        op.execute(
            f"CREATE TRIGGER audit_no_{action.lower()} BEFORE {action} ON audit "
            "BEGIN SELECT RAISE(ABORT, 'the audit is append-only'); END"
        )
