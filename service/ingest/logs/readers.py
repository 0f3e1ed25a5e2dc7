"""The reader of a log by its first bytes, and what to do where its library is missing."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module

from estimator.message import say
from service.ingest.formats import MCAP, SQLITE, ULOG
from service.ingest.logs.table import LogTable, Stream, log_table
from service.kit.limits import refusal

Read = Callable[[bytes, str], "Contents"]
ROOMS = {ULOG: "ulog", MCAP: "mcap_file", SQLITE: "sqlite_bag"}
"""Modules beside this one that read them; each needs a library."""


@dataclass(frozen=True)
class Contents:
    """What a log holds of its IMUs."""

    streams: Sequence[Stream]
    facts: dict[str, object]
    """What it says of the session besides."""


def log_of(content: bytes, filename: str) -> LogTable | None:
    """The table of a log; None of any other file."""
    room = next((room for magic, room in ROOMS.items() if content.startswith(magic)), None)
    if room is None:
        return None
    found = _reader(room, filename)(content, filename)
    return log_table(found.streams, filename, found.facts)


def _reader(room: str, filename: str) -> Read:
    try:
        read: Read = import_module(f"service.ingest.logs.{room}").read
    except ModuleNotFoundError as fault:
        text = say(
            "is a log, for which the library {name} is missing here: run pip install 'imu-health[logs]'",
            name=fault.name,
        )
        raise refusal(filename, text) from fault
    return read
