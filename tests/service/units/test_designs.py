"""Units whose files name no type share one with units of their design, and with no others."""

from datetime import UTC, datetime

import pytest

from service.storage import Storage
from service.units.store import Register
from service.uploads.receive import upload
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_sessions import in_counts

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def type_of(storage: Storage, serial: str) -> str:
    """The name of a unit's type."""
    with storage.database.reading() as store:
        return Register(store).get(serial).unit_type


@pytest.mark.parametrize("another_range", [0.25, 4.0])
def test_units_of_one_design_have_one_type_and_another_range_is_another_design(
    storage: Storage, another_range: float
) -> None:
    for content in (
        in_counts("C-1", 1e4),
        in_counts("C-2", 1e4 * another_range),
        in_counts("C-3", 1e4, rounding=1.01),
        in_counts("C-4", 1e4 * another_range),
    ):
        upload(storage, content, "a.json", NOW)
    one, other, *others = (type_of(storage, f"C-{n}") for n in range(1, 5))
    assert one == "accelerometer × 6, LSB"
    assert other.startswith(f"{one}, ")
    assert others == [one, other]
