"""One line of a paper."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Fact:
    """A name and what is stated of it."""

    name: str
    value: str
    is_written: bool = False
    """Whether the value is what somebody named or wrote: it is the same in every language."""
