"""Findings of a group in people's words."""

import pytest

from service.groups.words import with_days


@pytest.mark.parametrize("moment", ["2026-05-03T09:00:00Z", "2026-05-03T09:00:00+00:00", "2026-05-03T09:00:00.5+03:00"])
def test_a_moment_in_a_note_is_a_day(moment: str) -> None:
    assert with_days(f"taken out: {moment}, and no more") == "taken out: 3 May 2026, and no more"
