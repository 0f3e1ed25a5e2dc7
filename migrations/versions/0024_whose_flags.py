"""Gives every flag its subject: a unit, a type or a stand.

What the sessions of a type or on a stand show together hung on the unit that was measured last; it says now whose it
is, and counts as a flag of no unit.

Revision: 0024, after 0023
"""

import sqlalchemy as sa
from alembic import op

revision = "0024"
down_revision = "0023"
branch_labels = None
depends_on = None

SCOPES = ("unit type", "stand")
FLAGS = sa.table("flags", *map(sa.column, ("id", "unit_id", "matter", "place", "state", "scope", "subject")))
COUNTED = sa.table("conditions", sa.column("unit_id"), sa.column("flags"))
TALLY = ("unit_type_id", "severity", "is_reference", "is_simulated", "bar")
TALLIED = sa.table("tallied", sa.column("unit_id"), sa.column("flags"), *map(sa.column, TALLY))
TALLIES = sa.table("fleet_tallies", sa.column("flags"), *map(sa.column, TALLY))


def upgrade() -> None:
    """The place of a flag begins with whose it is: ``stand ODG-1: beta eccentricity``."""
    op.add_column("flags", sa.Column("scope", sa.String(10), nullable=False, server_default="unit"))
    op.add_column("flags", sa.Column("subject", sa.String(200), nullable=False, server_default=""))
    found = op.get_bind().execute(sa.select(FLAGS).where(FLAGS.c.matter == "lasting").order_by(FLAGS.c.id))
    for flag in found.all():
        scope = next((s for s in SCOPES if flag.place.startswith(f"{s} ")), None)
        if scope is not None:
            subject = flag.place.removeprefix(f"{scope} ").rpartition(": ")[0]
            op.execute(sa.update(FLAGS).where(FLAGS.c.id == flag.id).values(scope=scope, subject=subject))
            if flag.state != "resolved":
                _count(flag.unit_id, -1)


def downgrade() -> None:
    """They count as flags of the units again."""
    own = sa.select(FLAGS.c.unit_id).where(FLAGS.c.scope != "unit", FLAGS.c.state != "resolved")
    for unit in op.get_bind().scalars(own).all():
        _count(unit, 1)
    op.drop_column("flags", "subject")
    op.drop_column("flags", "scope")


def _count(unit: int, more: int) -> None:
    """So many flags more are open on a unit."""
    op.execute(sa.update(COUNTED).where(COUNTED.c.unit_id == unit).values(flags=COUNTED.c.flags + more))
    for row in op.get_bind().execute(sa.select(TALLIED).where(TALLIED.c.unit_id == unit)).all():
        op.execute(sa.update(TALLIED).where(TALLIED.c.unit_id == unit).values(flags=TALLIED.c.flags + more))
        same = [TALLIES.c[name] == getattr(row, name) for name in TALLY]
        op.execute(sa.update(TALLIES).where(*same).values(flags=TALLIES.c.flags + more))
