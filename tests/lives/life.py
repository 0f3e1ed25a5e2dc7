"""One life: a machine that takes steps by chance on a running service, and what must hold after each and at the end."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from hypothesis import HealthCheck, Phase, assume, seed, settings
from hypothesis import strategies as st
from hypothesis.stateful import initialize, invariant, run_state_machine_as_test

from tests.databases import Databases
from tests.lives.again import same_of_the_backup, same_of_the_records
from tests.lives.faults import Faults
from tests.lives.invariants import log_is_clean, look_around, pages_agree, walk
from tests.lives.quiet import wait_until_quiet
from tests.lives.records import Records
from tests.lives.service import Service
from tests.lives.steps import Steps
from tests.lives.works import Works
from tests.lives.world import World, opened
from tests.service.receiver import receiver

NOBODY = "127.0.0.1:9"
"""An address at which nobody listens."""
FIRST = (("LV-101", 0), ("LV-101", 2), ("FL-790", 0))
"""Sessions on record when a life begins."""
LOOKS = 4
"""Addresses that are read after every step."""


@dataclass(frozen=True)
class Size:
    """Length of a life, and of the inspection at its end."""

    steps: int
    pages: int
    """Number of pages, and of answers to programs, that are read."""
    ends: tuple[Callable[[World, Databases, Path], None], ...] = (same_of_the_backup, same_of_the_records)
    """Comparisons at the end."""
    prints: bool = True
    """Whether printed papers are read."""


LONG = Size(40, 500)
SHORT = Size(8, 12, (same_of_the_records,), prints=False)
RESTORED = replace(SHORT, ends=(same_of_the_backup,))
"""The short size, with the other end."""


class Life(Faults, Records, Works):
    """A service's life, step by step."""

    @initialize(drawn=st.integers(0, 2**32))
    def begins(self, drawn: int) -> None:
        """Hypothesis begins with the plainest of all lives, in which every step is the first rule."""
        assume(drawn)
        for serial, number in FIRST:
            self.sends(serial=serial, number=number, kind="json", odd=[], is_check=False)

    @invariant()
    def holds(self) -> None:
        """Checks the invariants after every step."""
        self.world.counts["steps"] += 1
        pages_agree(self.world)
        look_around(self.world, LOOKS)
        log_is_clean(self.world)


def lived(machine: type[Steps], world: World, number: int, steps: int) -> None:
    """Runs so many steps of a machine, seeded by a number."""
    one = seed(number)(type("OneLife", (machine,), {"world": world}))
    chosen = settings(
        max_examples=1,
        stateful_step_count=steps,
        phases=[Phase.generate],
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    run_state_machine_as_test(one, settings=chosen)


def end(world: World, databases: Databases, folder: Path, size: Size) -> None:
    """All that must hold once a life is over."""
    wait_until_quiet(world)
    walk(world, size.pages)
    pages_agree(world, everything=True)
    log_is_clean(world)
    for compared in size.ends:
        compared(world, databases, folder)
    log_is_clean(world)


def whole_life(databases: Databases, folder: Path, number: int, size: Size, seen: Callable[[World], None]) -> None:
    """A life and its end on a database of its own; ``seen`` is called with its world."""
    url = databases.migrated()
    try:
        with receiver() as hook, opened(Service(url, folder / "life", (hook.host, NOBODY)), number) as world:
            seen(world)
            world.is_short = not size.prints
            lived(Life, world, number, size.steps)
            end(world, databases, folder, size)
    finally:
        databases.drop(url)
