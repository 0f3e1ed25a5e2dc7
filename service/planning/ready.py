"""What is asked of the first minutes of a measurement: how long it will take, and by which tolerances."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from estimator.readiness import Allowed, Question
from estimator.readiness.question import USUAL
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.kit.measures import MEASURES
from service.planning.question import Amount, blank

MINUTE = 60.0
"""s."""


class ReadyQuestion(BaseModel):
    """What is asked; what is left out is the unit type's, or the usual."""

    model_config = ConfigDict(frozen=True)

    minutes: Annotated[Annotated[float, Field(ge=1, le=1440, allow_inf_nan=False)] | None, BeforeValidator(blank)] = (
        Field(None, description="How long the measurement will take, minutes; as the last session of the unit or type.")
    )
    unit_type: Annotated[str | None, Field(max_length=200, pattern=r"^[^\x00]*$"), BeforeValidator(blank)] = Field(
        None, description="A stored unit type by whose tolerances is judged; without it the one of the file's unit."
    )
    bias: Amount = Field(None, description="Tolerance of the bias, µg (gyros: °/h), instead of the type's.")
    scale: Amount = Field(None, description="Tolerance of the scale factor, ppm, instead of the type's.")
    coefficient: Amount = Field(
        None, description="Temperature coefficient of the zeros at most, µg/K (gyros: °/h/K); without it none is used."
    )

    def question(self, kind: str, tolerances: Mapping[tuple[str, str], float], usual: float | None) -> Question:
        """In SI, for a record whose leading sensors are of a kind; ``usual`` s that such sessions take."""
        own = {
            name: getattr(self, name) / MEASURES[kind, name].factor for name in ("bias", "scale") if getattr(self, name)
        }
        kept = {
            (k, name): own.get(name, tolerance) if k == kind else tolerance
            for (k, name), tolerance in tolerances.items()
        }
        kept |= {(kind, name): tolerance for name, tolerance in own.items()}
        allowed = {
            k: Allowed(kept.get((k, "bias")), kept.get((k, "scale")), kept.get((k, "quadratic")))
            for k in (ACCELEROMETER, GYROSCOPE)
        }
        slope = None if self.coefficient is None else {kind: self.coefficient / MEASURES[kind, "bias"].factor}
        return Question(allowed, MINUTE * self.minutes if self.minutes else usual or USUAL, coefficient=slope)
