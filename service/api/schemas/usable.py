"""May a unit be used?"""

from datetime import date, datetime

from pydantic import BaseModel, Field

from service.records.decision import Verdict


class UsableSchema(BaseModel):
    """The one question of a ground computer, answered."""

    usable: bool = Field(description="In doubt it is false.")
    why: str = Field(description="In one sentence.")
    reasons: list[str] = Field(description="Everything that speaks against it; empty where it may be used.")
    reservations: list[str] = Field(description="What must be known although it does not forbid the use.")
    reservation: str = Field(description="The same as one text; empty where there is none.")
    until: datetime | None = Field(description="The next calibration is due then, UTC.")
    next_calibration: date | None = Field(description="The day of it.")
    verdict: Verdict | None = Field(description="Of the session that the answer rests on.")
    session: str | None = Field(description="The latest judged one; null where there is none since the last service.")
    correction: str | None = Field(description="Address of the correction that firmware applies.")
    as_of: datetime = Field(description="When it was asked, UTC.")
