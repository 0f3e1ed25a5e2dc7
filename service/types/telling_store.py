"""What tells of a unit type or a stand: what was measured; what was simulated only while nothing else is there."""

from sqlalchemy import ColumnElement, or_, select
from sqlalchemy.orm import aliased

from service.sessions.tables import SessionRow
from service.units.tables import UnitRow


def tells_of_type(unit_type: int) -> ColumnElement[bool]:
    """Of units of a type."""
    other = aliased(UnitRow)
    measured = select(other.id).where(other.unit_type_id == unit_type, other.simulated.is_(False)).exists()
    return or_(UnitRow.simulated.is_(False), ~measured)


def tells_of_stand(stand: ColumnElement[int] | int) -> ColumnElement[bool]:
    """Of sessions on a stand."""
    other = aliased(SessionRow)
    measured = select(other.id).where(other.stand_id == stand, other.simulated.is_(False)).exists()
    return or_(SessionRow.simulated.is_(False), ~measured)
