"""Flow: a table of one's own layout with its mapping → stored like every session; how it was read is remembered."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any

from estimator.errors import Problem, SessionError
from service.errors import RefusedError
from service.flows.receive import Reception, receive
from service.ingest import look_at
from service.ingest.layout.envelope import wrapped
from service.ingest.layout.fingerprint import fingerprint
from service.ingest.layout.mapping import layout_of, remembered
from service.records.received import SentFile, held
from service.records.session import Receipt

NO_TABLE = "is given with a file that says itself what it is; send that without a mapping"


def receive_mapped(reception: Reception, file: SentFile, mapping: Mapping[str, Any], now: datetime) -> Receipt:
    """Stores the bytes, unchanged, and the mapping with them; RefusedError where they give no session."""
    whole, layout = _complete(file, mapping)
    receipt = receive(reception, replace(file, content=wrapped(whole, held(file.content))), now)
    with reception.storage.database.writing() as store:
        unit_type = store.unit_types.of_unit(receipt.unit).name
        store.layouts.remember(layout, unit_type, remembered(whole), who=reception.who, at=now)
    return receipt


def _complete(file: SentFile, mapping: Mapping[str, Any]) -> tuple[dict[str, Any], str]:
    """The mapping with how the file is taken apart stated in full, so that it is read the same for ever."""
    try:
        layout_of(mapping, file.filename)
        seen = look_at(wrapped(mapping, held(file.content)), file.filename)
    except SessionError as fault:
        raise RefusedError(f"{file.filename} cannot be read by this mapping.", fault.problems) from fault
    if seen["session"]:
        raise RefusedError(f"{file.filename} needs no mapping.", (Problem("mapping", NO_TABLE),))
    return {**mapping, "table": dict(seen["taken"])}, fingerprint(seen)
