"""A file's size is kept whatever it is."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from service.errors import RefusedError
from service.kit.arriving_files import Landed
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.files import content_hash
from service.storage.schema import downgrade, upgrade
from service.uploads.receive import upload
from service.uploads.records import ArrivalQuery
from service.uploads.store import Arrivals
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, tzinfo=UTC)
LONG = 3 * 1024**3
"""Bytes: 3 GiB, beyond 32 bits."""


def as_long(content: bytes, folder: Path) -> Landed:
    """A short file that is said to be long, so that none of that size must be written."""
    (folder / "landed").write_bytes(content)
    return Landed(folder / "landed", content_hash(content), LONG)


def test_sessions_and_refusals_keep_sizes_beyond_32_bits(storage: Storage, tmp_path: Path) -> None:
    upload(storage, as_long(session_bytes(), tmp_path), "a.json", NOW)
    with pytest.raises(RefusedError):
        upload(storage, as_long(b"{}", tmp_path), "b.json", NOW)
    with storage.database.reading() as store:
        found = Arrivals(store).page(ArrivalQuery(limit=3))
    assert [file.size for one in found for file in (one.session, one.refusal) if file is not None] == [LONG, LONG]


@pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
def test_a_schema_without_room_for_it_keeps_the_largest_size_that_it_can(
    store_url: str, storage: Storage, tmp_path: Path
) -> None:
    id = upload(storage, as_long(session_bytes(), tmp_path), "a.json", NOW).id
    storage.database.close()
    downgrade(store_url, "0027")
    upgrade(store_url)
    with storage.database.reading() as store:
        assert Sessions(store).get(id).size == 2**31 - 1
