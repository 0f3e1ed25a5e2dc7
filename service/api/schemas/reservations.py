"""A verdict with what it is said with."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field, computed_field, field_validator

from service.records.decision import Verdict
from service.records.reservation import Doubt, Reservation
from service.words.conditions import QUESTIONED, condition_of
from service.words.reservation import AGAIN, LOOKING
from service.words.verdict import verdict_in_words

STILL_LOOKING = Reservation(Doubt.PENDING, LOOKING, AGAIN)
"""Of a verdict whose session is not diagnosed yet."""


class ReservationSchema(BaseModel):
    """One thing that speaks against taking a verdict as it stands."""

    model_config = ConfigDict(from_attributes=True)

    kind: Doubt = Field(
        description="`record`: the file is wrong. `not-checked`: no causes could be looked for. `pending`: they are "
        "still being looked for; ask again. `temperature`: it was measured far from the temperatures of the unit's "
        "reference and earlier sessions, which can make or hide a change. `cause`: a named cause takes more than a "
        "third of a tolerance. `other-model`: the verdict is another under a model that the readings leave standing. "
        "`unexplained`: so does structure that no known cause explains. `stated-errors`: the readings contradict the "
        "standard errors of the file."
    )
    text: str = Field(description="What is the matter, as a clause that stands after `but`.")
    advice: str = Field(description="What to do about it, as a clause.")
    sensors: list[str] = Field(description="That it concerns; empty where it concerns all, or none in particular.")
    cause: str | None = Field(description="The named cause.")
    parameter: str | None = Field(description="Whose tolerance the size is held against.")
    size: float | None = Field(description="In the tolerance's unit, SI; relative for a scale factor.")
    uncertainty: float | None = Field(description="Standard uncertainty of the size.")
    share: float | None = Field(description="Size by tolerance.")
    verdict: Verdict | None = Field(description="That the session would have under the other model.")


class SaidVerdict(BaseModel):
    """A verdict that is said with its reservations."""

    verdict: Verdict | None
    is_reference: bool
    reservations: list[ReservationSchema] = Field(
        description="What speaks against taking the verdict as it stands; one of kind `pending` while causes are still "
        "being looked for. Empty where the verdict is plain."
    )

    @field_validator("reservations", mode="before")
    @classmethod
    def _told(cls, known: Any) -> Any:
        return (STILL_LOOKING,) if known is None else known

    def _is_questioned(self) -> bool:
        """Whether it tells nothing until an engineer accepts it."""
        return False

    @computed_field(description="The verdict in words, in one breath with its reservations.")  # type: ignore[prop-decorator]
    @property
    def said(self) -> str:
        """Made of the other fields."""
        if self._is_questioned():
            return QUESTIONED.word
        known = tuple(Reservation(r.kind, r.text, r.advice) for r in self.reservations)
        plain = None if Doubt.PENDING in (one.kind for one in known) else known
        return verdict_in_words(condition_of(self.verdict, is_reference=self.is_reference), plain)
