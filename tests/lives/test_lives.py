"""Short lives of a running service, always the same ones; `make lives` lives many and long ones by chance."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.databases import Databases
from tests.lives.life import RESTORED, SHORT, Size, whole_life
from tests.lives.twins import twin_life
from tests.lives.world import FindError, World


@pytest.mark.parametrize(
    ("databases", "number", "size"), [("sqlite", 3, SHORT), ("postgresql", 8, RESTORED)], indirect=["databases"]
)
def test_whatever_is_done_nothing_fails_and_the_state_follows_from_the_records(
    databases: Databases, number: int, size: Size, tmp_path: Path
) -> None:
    finds_nothing(lambda seen: whole_life(databases, tmp_path, number, size, seen))


def test_what_was_set_aside_or_taken_back_moves_nothing(sqlite: Databases, tmp_path: Path) -> None:
    finds_nothing(lambda seen: twin_life(sqlite, tmp_path, 5, 4, seen))


def finds_nothing(life: Callable[[Callable[[World], None]], None]) -> None:
    worlds = list[World]()
    try:
        life(worlds.append)
    except FindError as find:
        pytest.fail("\n".join([str(find), *(line for world in worlds for line in world.journal)]))
