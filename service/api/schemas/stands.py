"""Stands and their own health."""

from pydantic import BaseModel, Field

from service.records.stand import StandCondition


class StandList(BaseModel):
    """All stands, by name."""

    stands: tuple[StandCondition, ...] = Field(description="The stands.")
