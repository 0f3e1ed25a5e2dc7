"""The log: one line an event with named fields, as JSON for programs and in columns on a terminal.

What enters it is named field by field where it is logged: no body, no query string, no secret. A traceback shows code,
never the values of variables.
"""

import logging
import sys
from typing import TextIO

import structlog
from structlog.stdlib import BoundLogger, ProcessorFormatter
from structlog.typing import Processor

REQUEST_ID = "X-Request-Id"
"""The header under which a request is known, here and in the logs of those who sent it."""
NAME = "imu_health"
"""Name of the service's logger among those of its libraries."""
FIELDS: tuple[Processor, ...] = (
    structlog.contextvars.merge_contextvars,
    structlog.stdlib.add_log_level,
    structlog.stdlib.add_logger_name,
    structlog.processors.TimeStamper(fmt="iso", utc=True),
    structlog.processors.format_exc_info,
)
"""Processors for the fields of every line besides its own."""

log: BoundLogger = structlog.wrap_logger(
    logging.getLogger(NAME),
    processors=[structlog.stdlib.filter_by_level, *FIELDS, ProcessorFormatter.wrap_for_formatter],
    wrapper_class=BoundLogger,
)
"""The service's log; until `write_log` is called only warnings are shown."""


def request_id() -> str | None:
    """The id of the request that is being answered; None in the background."""
    found: str | None = structlog.contextvars.get_contextvars().get("request_id")
    return found


def write_log(to: TextIO = sys.stderr) -> None:
    """Writes the service's lines, and warnings of its libraries, to a stream."""
    handler = logging.StreamHandler(to)
    handler.setFormatter(
        ProcessorFormatter(
            processors=[ProcessorFormatter.remove_processors_meta, _renderer(to)], foreign_pre_chain=FIELDS
        )
    )
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)
    logging.getLogger(NAME).setLevel(logging.INFO)


def _renderer(to: TextIO) -> Processor:
    if to.isatty():
        return structlog.dev.ConsoleRenderer(exception_formatter=structlog.dev.plain_traceback)
    return structlog.processors.JSONRenderer()
