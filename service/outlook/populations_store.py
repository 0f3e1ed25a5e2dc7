"""How the units of types drift, as it was last made; who is far out is read from the furthest on."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import datetime

from sqlalchemy import Row, Select, delete, func, or_, select

from service.outlook.populations import Placed, Population
from service.outlook.tables import PopulationRow
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow


@dataclass(frozen=True)
class FarOut:
    """The populations with the furthest units and lots, and among how many these are."""

    populations: tuple[Population, ...]
    rates: int
    lots: int


class Populations(Queries):
    """Centre and spread of every parameter's rates, by type."""

    def put(self, unit_type: int, found: Sequence[Population], at: datetime) -> None:
        """Rewrites what is known of a type."""
        self._session.execute(delete(PopulationRow).where(PopulationRow.unit_type_id == unit_type))
        self._session.add_all(_row(unit_type, one, at) for one in found)
        self._session.flush()

    def of_type(self, name: str) -> tuple[Population, ...]:
        """Of every parameter of a type."""
        rows = self._session.execute(_populations().where(UnitTypeRow.name == name))
        return tuple(_population(row) for row in rows)

    def furthest(self, most: int) -> FarOut:
        """So many populations of those with the furthest units, and of those with the furthest lots."""
        own = PopulationRow
        far, lots = (
            select(column).where(column > 0).order_by(column.desc()).offset(most - 1).limit(1).scalar_subquery()
            for column in (own.furthest, own.furthest_lot)
        )
        among = (func.coalesce(select(func.sum(column)).scalar_subquery(), 0) for column in (own.rates, own.lots))
        query = (
            _populations()
            .add_columns(*among)
            .where(
                or_(
                    (own.furthest > 0) & (own.furthest >= func.coalesce(far, 0.0)),
                    (own.furthest_lot > 0) & (own.furthest_lot >= func.coalesce(lots, 0.0)),
                )
            )
        )
        rows = self._session.execute(query.order_by(own.unit_type_id, own.kind, own.parameter)).all()
        rates, lots_in_all = rows[0][2:] if rows else (0, 0)
        return FarOut(tuple(_population(row[:2]) for row in rows), rates, lots_in_all)

    def most_evident(self, most: int) -> tuple[Population, ...]:
        """So many of those with the units that are furthest out beyond chance, the furthest first."""
        query = _populations().where(PopulationRow.most_evident > 0)
        order = (PopulationRow.most_evident.desc(), PopulationRow.unit_type_id, PopulationRow.kind)
        rows = self._session.execute(query.order_by(*order, PopulationRow.parameter).limit(most))
        return tuple(_population(row) for row in rows)


def _populations() -> Select[PopulationRow, str]:
    return select(PopulationRow, UnitTypeRow.name).join(UnitTypeRow, UnitTypeRow.id == PopulationRow.unit_type_id)


def _row(unit_type: int, one: Population, at: datetime) -> PopulationRow:
    return PopulationRow(
        unit_type_id=unit_type,
        kind=one.kind,
        parameter=one.parameter,
        centre=one.centre,
        spread=one.spread,
        rates=one.rates,
        lots=one.lots,
        furthest=max((abs(placed.z) for placed in one.fast), default=0.0),
        furthest_lot=max((abs(z) for _, z in one.far_lots), default=0.0),
        most_evident=max((abs(placed.z) for placed in one.evident), default=0.0),
        far={
            "fast": [asdict(placed) for placed in one.fast],
            "evident": [asdict(placed) for placed in one.evident],
            "lots": [list(lot) for lot in one.far_lots],
        },
        made_at=at,
    )


def _population(found: Row[PopulationRow, str] | Sequence[object]) -> Population:
    row, unit_type = found
    assert isinstance(row, PopulationRow)
    return Population(
        unit_type=str(unit_type),
        kind=row.kind,
        parameter=row.parameter,
        centre=row.centre,
        spread=row.spread,
        rates=row.rates,
        lots=row.lots,
        fast=tuple(Placed(**placed) for placed in row.far["fast"]),
        evident=tuple(Placed(**placed) for placed in row.far["evident"]),
        far_lots=tuple((name, z) for name, z in row.far["lots"]),
    )
