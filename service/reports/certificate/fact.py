"""One line of a paper."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Fact:
    """A name and what is stated of it."""

    name: str
    value: str
