"""Faults that pydantic finds are messages with their parts, so that they can be translated."""

from enum import Enum
from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, Field, ValidationError, field_validator

from estimator.message import Message
from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.web.faults import fault_in_words


class Kind(Enum):
    STAND, UNIT = "stand", "unit"


class Asked(BaseModel):
    """A request with a field of every kind."""

    number: Annotated[int, Field(gt=1, lt=9)] = 2
    least: Annotated[int, Field(ge=1, le=9)] = 2
    text: Annotated[str, Field(min_length=2, max_length=3, pattern="^a")] = "aa"
    listed: Annotated[list[int], Field(min_length=1, max_length=2)] = [1]
    kind: Kind = Kind.UNIT
    way: Literal["up", "down"] = "up"
    own: str = ""

    @field_validator("own")
    @classmethod
    def own_is_empty(cls, own: str) -> str:
        if own:
            raise ValueError("it is not empty")
        return own


@pytest.mark.parametrize(
    ("brought", "expected"),
    [
        ({"number": 1}, "Должно быть больше 1"),
        ({"number": 9}, "Должно быть меньше 9"),
        ({"least": 0}, "Должно быть не меньше 1"),
        ({"least": 10}, "Должно быть не больше 9"),
        ({"text": "a"}, "Знаков должно быть не меньше 2"),
        ({"text": "aaaa"}, "Знаков должно быть не больше 3"),
        ({"text": "bb"}, "Текст должен отвечать образцу '^a'"),
        ({"listed": []}, "Элементов должно быть не меньше 1, а их 0"),
        ({"kind": "x"}, "Должно быть 'stand' или 'unit'"),
        ({"way": "x"}, "Должно быть 'up' или 'down'"),
        ({"own": "x"}, "Ошибка значения: it is not empty"),
    ],
)
def test_a_fault_is_said_by_its_parts(brought: dict[str, object], expected: str) -> None:
    with pytest.raises(ValidationError) as caught:
        Asked.model_validate(brought)
    (fault,) = caught.value.errors()
    message = fault_in_words(fault)
    assert isinstance(message, Message)
    assert message == fault["msg"]
    assert catalogue_of(Language.RUSSIAN).say(message) == expected


def test_a_fault_without_parts_stays_as_it_is() -> None:
    assert fault_in_words({"type": "missing", "msg": "Field required", "loc": ()}) == "Field required"
