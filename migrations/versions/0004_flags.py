"""Person and sensor of a service, notes, stages of sessions, flags with their notices, webhooks with an outbox.

Revision: 0004, after 0003
"""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

KINDS = {"sensor swap": "sensor-swap", "new reference": "reference"}
"""Kinds of service as they were called before."""
SERVICE_KEY = "uq_services_unit_id_at_kind"
APPEND_ONLY = ("notes", "note_withdrawals", "notices")


def upgrade() -> None:
    """Adds flags; none is open until the next session of a unit."""
    op.add_column("sessions", sa.Column("stage", sa.String(20)))
    op.add_column("conditions", sa.Column("flags", sa.Integer(), nullable=False, server_default="0"))
    _services()
    _notes()
    _flags()
    _notices()
    _webhooks()
    for table in APPEND_ONLY:
        _make_append_only(table)


def downgrade() -> None:
    """The first service stays where several were of one kind at one moment on several sensors."""
    for table in ("deliveries", "webhooks", "notices", "flags", "note_withdrawals", "notes"):
        op.drop_table(table)
    if op.get_bind().dialect.name == "postgresql":
        op.execute("DROP FUNCTION line_is_append_only()")
    _first_service_only()
    _rename({new: old for old, new in KINDS.items()})
    with op.batch_alter_table("services") as altered:
        altered.drop_constraint(f"{SERVICE_KEY}_sensor", type_="unique")
        altered.create_unique_constraint(SERVICE_KEY, ["unit_id", "at", "kind"])
        altered.drop_column("who")
        altered.drop_column("sensor")
    op.drop_column("conditions", "flags")
    op.drop_column("sessions", "stage")


def _services() -> None:
    with op.batch_alter_table("services") as altered:
        altered.add_column(sa.Column("who", sa.String(), nullable=False, server_default=""))
        altered.add_column(sa.Column("sensor", sa.String(200), nullable=False, server_default=""))
        altered.drop_constraint(SERVICE_KEY, type_="unique")
        altered.create_unique_constraint(f"{SERVICE_KEY}_sensor", ["unit_id", "at", "kind", "sensor"])
    _rename(KINDS)


def _rename(names: dict[str, str]) -> None:
    services = sa.table("services", sa.column("kind"))
    for old, new in names.items():
        op.execute(services.update().where(services.c.kind == old).values(kind=new))


def _first_service_only() -> None:
    services = sa.table("services", *map(sa.column, ("id", "unit_id", "at", "kind")))
    other = services.alias("other")
    first = sa.select(sa.func.min(other.c.id)).group_by(other.c.unit_id, other.c.at, other.c.kind)
    op.execute(services.delete().where(services.c.id.not_in(first)))


def _key(table: str) -> list[sa.schema.SchemaItem]:
    return [sa.Column("id", sa.Integer(), nullable=False), sa.PrimaryKeyConstraint("id", name=f"pk_{table}")]


def _text(*names: str) -> list[sa.Column[str]]:
    return [sa.Column(name, sa.String(), nullable=False) for name in names]


def _time(name: str, *, nullable: bool = False) -> sa.Column[object]:
    return sa.Column(name, sa.DateTime(timezone=True), nullable=nullable)


def _number(name: str, *, nullable: bool = False) -> sa.Column[int]:
    return sa.Column(name, sa.Integer(), nullable=nullable)


def _word(name: str, longest: int = 20, *, nullable: bool = False) -> sa.Column[str]:
    return sa.Column(name, sa.String(longest), nullable=nullable)


def _refers(table: str, column: str, target: str) -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint([column], [target], name=f"fk_{table}_{column}")


def _notes() -> None:
    op.create_table(
        "notes",
        *_key("notes"),
        _number("unit_id"),
        _time("at"),
        *_text("text", "who"),
        _time("recorded_at"),
        _refers("notes", "unit_id", "units.id"),
    )
    op.create_index("ix_notes_unit_id", "notes", ["unit_id"])
    op.create_table(
        "note_withdrawals",
        sa.Column("note_id", sa.Integer(), autoincrement=False, nullable=False),
        _time("at"),
        *_text("who", "why"),
        sa.PrimaryKeyConstraint("note_id", name="pk_note_withdrawals"),
        _refers("note_withdrawals", "note_id", "notes.id"),
    )


def _flags() -> None:
    op.create_table(
        "flags",
        *_key("flags"),
        _number("unit_id"),
        _word("matter"),
        _word("place", 200),
        _word("state"),
        _number("severity"),
        *_text("summary", "proposal"),
        _word("session_id", nullable=True),
        _time("raised_at"),
        _time("changed_at"),
        _refers("flags", "unit_id", "units.id"),
        _refers("flags", "session_id", "sessions.id"),
    )
    op.create_index("ix_flags_unit_id", "flags", ["unit_id", "id"])
    op.create_index("ix_flags_state", "flags", ["state", "id"])
    is_open = sa.text("state <> 'resolved'")
    op.create_index(
        "uq_flags_open",
        "flags",
        ["unit_id", "matter", "place"],
        unique=True,
        sqlite_where=is_open,
        postgresql_where=is_open,
    )


def _notices() -> None:
    op.create_table(
        "notices",
        *_key("notices"),
        _number("unit_id"),
        _number("flag_id", nullable=True),
        _word("kind"),
        _time("at"),
        *_text("who", "text"),
        _word("session_id", nullable=True),
        _refers("notices", "unit_id", "units.id"),
        _refers("notices", "flag_id", "flags.id"),
        _refers("notices", "session_id", "sessions.id"),
    )
    op.create_index("ix_notices_flag_id", "notices", ["flag_id", "id"])


def _webhooks() -> None:
    op.create_table(
        "webhooks",
        *_key("webhooks"),
        *_text("url", "secret", "who"),
        _time("created_at"),
        _time("removed_at", nullable=True),
    )
    op.create_table(
        "deliveries",
        *_key("deliveries"),
        _number("notice_id"),
        _number("webhook_id"),
        _word("state"),
        _number("attempts"),
        _time("next_at"),
        *_text("outcome"),
        sa.UniqueConstraint("webhook_id", "notice_id", name="uq_deliveries_webhook_id_notice_id"),
        _refers("deliveries", "notice_id", "notices.id"),
        _refers("deliveries", "webhook_id", "webhooks.id"),
    )
    is_waiting = sa.text("state = 'waiting'")
    op.create_index(
        "ix_deliveries_next_at", "deliveries", ["next_at"], sqlite_where=is_waiting, postgresql_where=is_waiting
    )


def _make_append_only(table: str) -> None:
    """The database itself refuses to change or delete a line."""
    if op.get_bind().dialect.name == "postgresql":
        op.execute(
            "CREATE OR REPLACE FUNCTION line_is_append_only() RETURNS trigger LANGUAGE plpgsql AS "
            "$$ BEGIN RAISE EXCEPTION '% is append-only', TG_TABLE_NAME; END $$"
        )
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
