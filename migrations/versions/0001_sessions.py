"""Units, sessions, calibrations, decisions, history, and the logs.

Revision: 0001, the first
"""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

TABLES = (
    "unit_types", "tolerance_revisions", "units", "stands", "services", "sessions", "calibrations", "parameters",
    "decisions", "conditions", "refusals", "audit",
)  # fmt: skip
"""Tables in the order in which they can be made."""


def upgrade() -> None:
    """Makes every table."""
    _units()
    _services()
    _sessions()
    _calibrations()
    _parameters()
    _decisions()
    _conditions()
    _refusals()
    _audit()
    _make_audit_append_only()


def downgrade() -> None:
    """Drops every table, the audit's guards with it."""
    for table in reversed(TABLES):
        op.drop_table(table)
    if op.get_bind().dialect.name == "postgresql":
        op.execute("DROP FUNCTION audit_is_append_only()")


def _key(table: str) -> list[sa.schema.SchemaItem]:
    return [
        sa.Column("id", sa.Integer(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=f"pk_{table}"),
    ]


def _time(name: str) -> sa.Column[object]:
    return sa.Column(name, sa.DateTime(timezone=True), nullable=False)


def _refers(table: str, column: str, target: str) -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint([column], [target], name=f"fk_{table}_{column}")


def _units() -> None:
    op.create_table(
        "unit_types",
        *_key("unit_types"),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("block", sa.String(40), nullable=False),
        sa.Column("sensors", sa.JSON(), nullable=False),
        sa.Column("nominal_axes", sa.JSON(), nullable=False),
        sa.Column("nominal_scales", sa.JSON(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.UniqueConstraint("name", name="uq_unit_types_name"),
    )
    op.create_table(
        "tolerance_revisions",
        sa.Column("unit_type_id", sa.Integer(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        _time("since"),
        sa.Column("tolerances", sa.JSON(), nullable=False),
        sa.Column("gyro_tolerances", sa.JSON(), nullable=True),
        sa.PrimaryKeyConstraint("unit_type_id", "revision", name="pk_tolerance_revisions"),
        _refers("tolerance_revisions", "unit_type_id", "unit_types.id"),
    )
    op.create_table(
        "units",
        *_key("units"),
        sa.Column("serial", sa.String(200), nullable=False),
        sa.Column("unit_type_id", sa.Integer(), nullable=False),
        sa.Column("simulated", sa.Boolean(), nullable=False),
        sa.UniqueConstraint("serial", name="uq_units_serial"),
        _refers("units", "unit_type_id", "unit_types.id"),
    )
    op.create_index("ix_units_unit_type_id", "units", ["unit_type_id"])


def _services() -> None:
    op.create_table(
        "stands",
        *_key("stands"),
        sa.Column("name", sa.String(200), nullable=False),
        sa.UniqueConstraint("name", name="uq_stands_name"),
    )
    op.create_table(
        "services",
        *_key("services"),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        _time("at"),
        sa.Column("kind", sa.String(40), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        _time("recorded_at"),
        sa.UniqueConstraint("unit_id", "at", "kind", name="uq_services_unit_id_at_kind"),
        _refers("services", "unit_id", "units.id"),
    )


def _sessions() -> None:
    op.create_table(
        "sessions",
        sa.Column("id", sa.String(20), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        sa.Column("stand_id", sa.Integer(), nullable=True),
        sa.Column("filename", sa.String(), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("block", sa.String(20), nullable=False),
        sa.Column("programme", sa.String(40), nullable=False),
        sa.Column("operator", sa.String(), nullable=False),
        sa.Column("notes", sa.String(), nullable=False),
        _time("started_at"),
        _time("uploaded_at"),
        sa.Column("verdict", sa.String(20), nullable=False),
        sa.Column("reason", sa.String(), nullable=False),
        sa.Column("worst_sensor", sa.String(), nullable=True),
        sa.Column("worst_parameter", sa.String(20), nullable=True),
        sa.Column("margin", sa.Double(), nullable=True),
        sa.Column("is_reference", sa.Boolean(), nullable=False),
        sa.Column("simulated", sa.Boolean(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_sessions"),
        sa.UniqueConstraint("sha256", name="uq_sessions_sha256"),
        _refers("sessions", "unit_id", "units.id"),
        _refers("sessions", "stand_id", "stands.id"),
    )
    op.create_index("ix_sessions_stand_id", "sessions", ["stand_id"])
    op.create_index("ix_sessions_started_at", "sessions", ["started_at"])
    op.create_index("ix_sessions_unit_id_started_at", "sessions", ["unit_id", "started_at", "id"])


def _calibrations() -> None:
    op.create_table(
        "calibrations",
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("method", sa.String(80), nullable=False),
        sa.Column("document", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("session_id", name="pk_calibrations"),
        _refers("calibrations", "session_id", "sessions.id"),
    )


def _parameter_key(table: str) -> list[sa.schema.SchemaItem]:
    return [
        sa.Column("session_id", sa.String(20), nullable=False),
        sa.Column("sensor", sa.String(200), nullable=False),
        sa.Column("parameter", sa.String(20), nullable=False),
        sa.PrimaryKeyConstraint("session_id", "sensor", "parameter", name=f"pk_{table}"),
        _refers(table, "session_id", "sessions.id"),
    ]


def _numbers(*names: str, nullable: bool = True) -> list[sa.Column[float]]:
    return [sa.Column(name, sa.Double(), nullable=nullable) for name in names]


def _parameters() -> None:
    op.create_table(
        "parameters",
        *_parameter_key("parameters"),
        sa.Column("unit_id", sa.Integer(), nullable=False),
        _time("at"),
        sa.Column("sensor_index", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        *_numbers("value", "u", "axis_x", "axis_y", "axis_z"),
        _refers("parameters", "unit_id", "units.id"),
    )
    op.create_index("ix_parameters_history", "parameters", ["unit_id", "at", "session_id", "sensor_index", "parameter"])


def _decisions() -> None:
    op.create_table(
        "decisions",
        *_parameter_key("decisions"),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(20), nullable=False),
        *_numbers("value", "reference", "deviation", "uncertainty", "expanded"),
        *_numbers("coverage_factor", "tolerance", nullable=False),
        *_numbers("guard_band", "probability_out"),
        sa.Column("verdict", sa.String(20), nullable=False),
        sa.Column("rule", sa.String(), nullable=False),
        *_numbers("critical"),
    )


def _conditions() -> None:
    op.create_table(
        "conditions",
        sa.Column("unit_id", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("sessions", sa.Integer(), nullable=False),
        sa.Column("last_session", sa.String(20), nullable=False),
        sa.Column("severity", sa.Integer(), nullable=False),
        *_numbers("margin"),
        sa.PrimaryKeyConstraint("unit_id", name="pk_conditions"),
        _refers("conditions", "unit_id", "units.id"),
        _refers("conditions", "last_session", "sessions.id"),
    )
    op.create_index("ix_conditions_worst_first", "conditions", ["severity", "margin", "unit_id"])


def _refusals() -> None:
    op.create_table(
        "refusals",
        *_key("refusals"),
        _time("at"),
        sa.Column("filename", sa.String(), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("problems", sa.JSON(), nullable=False),
    )
    op.create_index("ix_refusals_at", "refusals", ["at"])


def _audit() -> None:
    op.create_table(
        "audit",
        *_key("audit"),
        _time("at"),
        sa.Column("who", sa.String(), nullable=False),
        sa.Column("action", sa.String(40), nullable=False),
        sa.Column("subject", sa.String(), nullable=False),
        sa.Column("details", sa.JSON(), nullable=False),
    )
    op.create_index("ix_audit_at", "audit", ["at"])


def _make_audit_append_only() -> None:
    """The database itself refuses to change or delete a line of the audit."""
    if op.get_bind().dialect.name == "postgresql":
        op.execute(
            "CREATE FUNCTION audit_is_append_only() RETURNS trigger LANGUAGE plpgsql AS "
            "$$ BEGIN RAISE EXCEPTION 'the audit is append-only'; END $$"
        )
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
