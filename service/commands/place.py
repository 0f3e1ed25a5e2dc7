"""What a word on the command line means: a unit, or a session."""

import re
from http import HTTPStatus
from urllib.parse import quote

from service.client.connection import Connection
from service.errors import ServiceError

SESSION = re.compile("[0-9a-f]{20}")
"""What a session's id looks like; a serial number may look like one as well."""


def in_path(name: str) -> str:
    """A name as it stands in an address."""
    return quote(name, safe="")


def is_session(client: Connection, name: str) -> bool:
    """Whether a stored session has this id; anything else is taken for a unit's serial number."""
    if not SESSION.fullmatch(name):
        return False
    try:
        client.get(f"/sessions/{name}")
    except ServiceError as fault:
        if fault.status != HTTPStatus.NOT_FOUND:
            raise
        return False
    return True
