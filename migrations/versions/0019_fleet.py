"""Facts about the fleet as a whole in tables of their own: counts, drifts of the units of types, states of stands.

Counts are worked out here from what is stored. What types and stands show is asked for, and made by the service beside
its first requests. The views of 0018 read `outlooks` and `sessions`; columns are added to these, and no table is made
anew, so that they stay.

Revision: 0019, after 0018
"""

import json
import re
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"
branch_labels = None
depends_on = None

TALLIED = """
INSERT INTO tallied (unit_id, unit_type_id, severity, is_reference, is_simulated, bar, flags, reserved)
SELECT u.id, u.unit_type_id, COALESCE(c.severity, -1), COALESCE(s.is_reference, {false}), u.simulated,
    CASE WHEN c.margin IS NULL THEN -1 WHEN c.margin <= -1 THEN 20 ELSE CAST({floor} AS INTEGER) END,
    COALESCE(c.flags, 0), CASE WHEN d.reservations IS NULL THEN 0 ELSE 1 END
FROM units u
LEFT JOIN conditions c ON c.unit_id = u.id
LEFT JOIN sessions s ON s.id = c.last_session
LEFT JOIN diagnoses d ON d.session_id = c.last_session
"""
"""The bar is a tenth of the tolerance that is used, 1 − margin; the last one holds all from twice the tolerance on."""
FLOOR = {"sqlite": "10 * (1 - c.margin)", "postgresql": "floor(10 * (1 - c.margin))"}
"""SQLite cuts off when it casts."""
FALSE = {"sqlite": "0", "postgresql": "false"}
FLEET_TALLIES = """
INSERT INTO fleet_tallies (unit_type_id, severity, is_reference, is_simulated, bar, units, flags, reserved)
SELECT unit_type_id, severity, is_reference, is_simulated, bar, COUNT(*), SUM(flags), SUM(reserved) FROM tallied
GROUP BY unit_type_id, severity, is_reference, is_simulated, bar
"""
STAND_UNITS = """
INSERT INTO stand_units (unit_id, stand_id, sessions)
SELECT unit_id, stand_id, COUNT(*) FROM sessions WHERE stand_id IS NOT NULL AND state = 'accepted'
GROUP BY unit_id, stand_id
"""
STAND_TALLIES = """
INSERT INTO stand_tallies (stand_id, sessions, units)
SELECT stand_id, SUM(sessions), COUNT(*) FROM stand_units GROUP BY stand_id
"""
ASKED = """
INSERT INTO pending_summaries (level, group_id, asked_at, attempts)
SELECT '{level}', id, {now}, 0 FROM {table}
"""
NOW = {"sqlite": "strftime('%Y-%m-%d %H:%M:%S.000000')", "postgresql": "now()"}
LAST = """
UPDATE conditions SET last_at = (SELECT s.started_at FROM sessions s WHERE s.id = conditions.last_session),
    stand_id = (SELECT s.stand_id FROM sessions s WHERE s.id = conditions.last_session)
"""
AT_A_TIME = 500
"""Outlooks that are held in memory."""


def upgrade() -> None:
    """Tables, indexes, and the counts of what is stored."""
    engine = op.get_context().dialect.name
    _outlooks()
    _tables()
    _conditions()
    op.drop_index("ix_sessions_stand_id", "sessions")
    op.create_index("ix_sessions_stand_id_started_at", "sessions", ["stand_id", "started_at"])
    questioned = sa.text("state = 'questioned'")
    op.create_index(
        "ix_sessions_questioned", "sessions", ["uploaded_at"], sqlite_where=questioned, postgresql_where=questioned
    )
    opened = sa.text("state <> 'resolved'")
    op.create_index("ix_flags_open", "flags", ["id"], sqlite_where=opened, postgresql_where=opened)
    op.execute(TALLIED.format(floor=FLOOR[engine], false=FALSE[engine]))
    for statement in (FLEET_TALLIES, STAND_UNITS, STAND_TALLIES):
        op.execute(statement)
    for level, table in (("type", "unit_types"), ("stand", "stands")):
        op.execute(ASKED.format(level=level, table=table, now=NOW[engine]))


def _outlooks() -> None:
    """Reason and rates of every outlook, from its document."""
    op.add_column("outlooks", sa.Column("reason", sa.String(), nullable=False, server_default=""))
    op.add_column("outlooks", sa.Column("rates", sa.JSON(), nullable=False, server_default="[]"))
    op.create_index("ix_outlooks_due", "outlooks", ["due"])
    table = sa.table("outlooks", sa.column("unit_id"), sa.column("document", sa.JSON()), sa.column("reason"),
                     sa.column("rates", sa.JSON()))  # fmt: skip
    last, connection = -1, op.get_bind()
    while True:
        page = sa.select(table.c.unit_id, table.c.document).where(table.c.unit_id > last).order_by(table.c.unit_id)
        rows = connection.execute(page.limit(AT_A_TIME)).all()
        if not rows:
            return
        for unit, document in rows:
            written = document if isinstance(document, dict) else json.loads(document)
            values = {"reason": _text(written["reason"]), "rates": [_rate(trend) for trend in written["trends"]]}
            connection.execute(sa.update(table).where(table.c.unit_id == unit).values(**values))
        last = rows[-1][0]


def _text(sentence: str | dict[str, Any]) -> str:
    """The sentence in English; a later version that was here before may have kept it with its parts."""
    if isinstance(sentence, str):
        return sentence
    parts = {name: _text(part) for name, part in sentence.get("parts", {}).items()}
    template = sentence["message"] if sentence.get("number") in (None, 1) else sentence["many"]
    return re.sub(r"\{(\w+)\}", lambda place: parts.get(place[1], place[0]), template)


def _conditions() -> None:
    """Time and place of a unit's latest session, so that units of a stand are found without their sessions."""
    op.add_column("conditions", sa.Column("last_at", sa.DateTime(timezone=True), nullable=True))
    op.add_column("conditions", sa.Column("stand_id", sa.Integer(), nullable=True))
    op.execute(LAST)
    op.create_index("ix_conditions_last_at", "conditions", ["last_at"])
    op.create_index("ix_conditions_stand_id_last_at", "conditions", ["stand_id", "last_at"])


def _rate(trend: dict[str, object]) -> list[object]:
    tolerance = float(str(trend["tolerance"]))
    rate, sigma = (float(str(trend[name])) / tolerance for name in ("rate_per_year", "rate_sigma"))
    return [trend["sensor"], trend["kind"], trend["parameter"], rate, sigma, trend["significance"], tolerance]


def _tables() -> None:
    whole, yes = sa.Integer(), sa.Boolean()
    counts = ("units", "flags", "reserved")
    key = (("unit_type_id", whole), ("severity", whole), ("is_reference", yes), ("is_simulated", yes), ("bar", whole))
    op.create_table(
        "tallied",
        sa.Column("unit_id", whole, nullable=False, autoincrement=False),
        *(sa.Column(name, kind, nullable=False) for name, kind in key),
        *(sa.Column(name, whole, nullable=False) for name in counts[1:]),
        sa.PrimaryKeyConstraint("unit_id", name="pk_tallied"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_tallied_unit_id"),
    )
    op.create_table(
        "fleet_tallies",
        *(sa.Column(name, kind, nullable=False, autoincrement=False) for name, kind in key),
        *(sa.Column(name, whole, nullable=False) for name in counts),
        sa.PrimaryKeyConstraint(*(name for name, _ in key), name="pk_fleet_tallies"),
        sa.ForeignKeyConstraint(["unit_type_id"], ["unit_types.id"], name="fk_fleet_tallies_unit_type_id"),
    )
    op.create_table(
        "stand_units",
        sa.Column("unit_id", whole, nullable=False, autoincrement=False),
        sa.Column("stand_id", whole, nullable=False, autoincrement=False),
        sa.Column("sessions", whole, nullable=False),
        sa.PrimaryKeyConstraint("unit_id", "stand_id", name="pk_stand_units"),
        sa.ForeignKeyConstraint(["unit_id"], ["units.id"], name="fk_stand_units_unit_id"),
        sa.ForeignKeyConstraint(["stand_id"], ["stands.id"], name="fk_stand_units_stand_id"),
    )
    op.create_table(
        "stand_tallies",
        sa.Column("stand_id", whole, nullable=False, autoincrement=False),
        sa.Column("sessions", whole, nullable=False),
        sa.Column("units", whole, nullable=False),
        sa.PrimaryKeyConstraint("stand_id", name="pk_stand_tallies"),
        sa.ForeignKeyConstraint(["stand_id"], ["stands.id"], name="fk_stand_tallies_stand_id"),
    )
    _summaries()


def _summaries() -> None:
    whole, time = sa.Integer(), sa.DateTime(timezone=True)
    op.create_table(
        "populations",
        sa.Column("unit_type_id", whole, nullable=False, autoincrement=False),
        sa.Column("kind", sa.String(20), nullable=False),
        sa.Column("parameter", sa.String(20), nullable=False),
        *(sa.Column(name, sa.Double(), nullable=False) for name in ("centre", "spread")),
        *(sa.Column(name, whole, nullable=False) for name in ("rates", "lots")),
        *(sa.Column(name, sa.Double(), nullable=False) for name in ("furthest", "furthest_lot", "most_evident")),
        sa.Column("far", sa.JSON(), nullable=False),
        sa.Column("made_at", time, nullable=False),
        sa.PrimaryKeyConstraint("unit_type_id", "kind", "parameter", name="pk_populations"),
        sa.ForeignKeyConstraint(["unit_type_id"], ["unit_types.id"], name="fk_populations_unit_type_id"),
    )
    for name in ("furthest", "furthest_lot", "most_evident"):
        op.create_index(f"ix_populations_{name}", "populations", [name])
    op.create_table(
        "stand_conditions",
        sa.Column("stand_id", whole, nullable=False, autoincrement=False),
        sa.Column("shifts", whole, nullable=False),
        sa.Column("document", sa.JSON(), nullable=False),
        sa.Column("made_at", time, nullable=False),
        sa.PrimaryKeyConstraint("stand_id", name="pk_stand_conditions"),
        sa.ForeignKeyConstraint(["stand_id"], ["stands.id"], name="fk_stand_conditions_stand_id"),
    )
    op.create_table(
        "pending_summaries",
        sa.Column("id", whole, nullable=False),
        sa.Column("level", sa.String(10), nullable=False),
        sa.Column("group_id", whole, nullable=False),
        sa.Column("asked_at", time, nullable=False),
        sa.Column("claimed_until", time, nullable=True),
        sa.Column("attempts", whole, nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_pending_summaries"),
    )
    op.create_index("ix_pending_summaries_level_group_id", "pending_summaries", ["level", "group_id"])


def downgrade() -> None:
    """Drops the tables of the fleet, which can be worked out again."""
    for table in ("pending_summaries", "stand_conditions", "populations", "stand_tallies", "stand_units",
                  "fleet_tallies", "tallied"):  # fmt: skip
        op.drop_table(table)
    op.drop_index("ix_flags_open", "flags")
    op.drop_index("ix_sessions_questioned", "sessions")
    op.drop_index("ix_sessions_stand_id_started_at", "sessions")
    op.create_index("ix_sessions_stand_id", "sessions", ["stand_id"])
    op.drop_index("ix_conditions_stand_id_last_at", "conditions")
    op.drop_index("ix_conditions_last_at", "conditions")
    op.drop_column("conditions", "stand_id")
    op.drop_column("conditions", "last_at")
    op.drop_index("ix_outlooks_due", "outlooks")
    op.drop_column("outlooks", "rates")
    op.drop_column("outlooks", "reason")
