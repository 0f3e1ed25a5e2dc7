"""Sessions and services that count: what is known of a unit rests on accepted records alone."""

from service.records.state import RecordState
from service.storage.tables import ServiceRow, SessionRow

IS_ACCEPTED = SessionRow.state == RecordState.ACCEPTED
"""Sessions that tell of their unit."""
IS_BREAK = ServiceRow.state == RecordState.ACCEPTED
"""Services that begin an epoch."""
