"""The reader of a log by its first bytes, and advice where its library is missing."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from importlib import import_module

from estimator.message import say
from service.ingest.formats import MCAP, SQLITE, ULOG
from service.ingest.logs.table import LogTable, Stream, log_table
from service.kit.limits import refusal

Read = Callable[[bytes, str], "Contents"]
MODULES = {ULOG: "ulog", MCAP: "mcap_file", SQLITE: "sqlite_bag"}
"""Modules beside this one; each needs a library."""


@dataclass(frozen=True)
class Contents:
    """IMU data in a log."""

    streams: Sequence[Stream]
    facts: dict[str, object]
    """Facts of the session stated in the log."""


def log_of(content: bytes, filename: str, declined: Collection[str] = ()) -> LogTable | None:
    """The table of a log, screened but for ``declined`` kinds; None for any other file."""
    module = next((module for magic, module in MODULES.items() if content.startswith(magic)), None)
    if module is None:
        return None
    log = _reader(module, filename)(content, filename)
    return log_table(log.streams, filename, log.facts, declined)


def _reader(module: str, filename: str) -> Read:
    try:
        read: Read = import_module(f"service.ingest.logs.{module}").read
    except ModuleNotFoundError as fault:
        text = say(
            "is a log, for which the library {name} is missing here: run pip install 'imu-health[logs]'",
            name=fault.name,
        )
        raise refusal(filename, text) from fault
    return read
