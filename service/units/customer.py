"""For whom a unit is calibrated."""

from dataclasses import dataclass

from service.kit.answer import answer


@answer
@dataclass(frozen=True)
class Customer:
    """For whom a unit is calibrated, as its certificates name them."""

    name: str = ""
    """Empty where it is not stated."""
    address: str = ""
    """Where they can be reached."""


NOBODY = Customer()
"""Of a unit for which no customer is stated."""
