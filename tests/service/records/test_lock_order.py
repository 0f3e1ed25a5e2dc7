"""Long work is not done in a write transaction, and a place to read is taken before the turn to write."""

from collections.abc import Callable
from typing import Any

import pytest

from estimator.errors import SessionError
from service.ingest import in_turn, read_upload
from service.judging import calibrate, judge
from service.kit.lock_order import ComputedWhileWritingError
from service.outlook import changes as refresh_outlook
from service.records import diagnose, refresh_group, weigh
from service.storage import Storage
from tests.databases import one_engine

LONG = (
    read_upload,
    in_turn,
    calibrate.calibrate,
    judge.judge,
    judge.judge_recording,
    weigh.weigh,
    diagnose._made,
    refresh_group._answered,
    refresh_outlook.worked_out,
)


@one_engine
@pytest.mark.parametrize("function", LONG, ids=lambda own: f"{own.__module__}.{own.__name__}")
def test_nothing_is_worked_out_while_a_thread_writes(storage: Storage, function: Callable[..., Any]) -> None:
    with pytest.raises(ComputedWhileWritingError), storage.database.writing():
        function()


@one_engine
def test_it_is_worked_out_before_and_after(storage: Storage) -> None:
    with storage.database.writing():
        pass
    with pytest.raises(SessionError), storage.database.reading():
        read_upload(b"nothing", "a.json")
