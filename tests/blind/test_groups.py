"""Effects that no single session shows must be found in the group, at their level, and none where there is none."""

from typing import Any

import pytest

from estimator import diagnose_group, read_session
from tests.blind.group_score import GroupOutcome, score
from tests.blind.groups import Group, draw_group


def told(group: Group) -> tuple[GroupOutcome, dict[str, Any]]:
    """Marks and the answer."""
    found = diagnose_group([read_session(f) for f in group.sessions], group.level).to_dict()
    return score(group, found), found


@pytest.mark.slow
@pytest.mark.parametrize(("level", "seed"), [("unit", 2), ("stand", 3), ("type", 3)])
def test_an_effect_too_small_for_a_session_is_named_at_its_level(level: str, seed: int):
    outcome, found = told(draw_group(level, "one", (31, seed)))
    assert outcome.listed == (True,), (outcome, found["notes"])
    assert outcome.first or not outcome.clear, outcome


@pytest.mark.slow
def test_an_effect_that_began_some_day_is_told_as_such():
    group = draw_group("unit", "one", (4, 1), form="since")
    outcome, found = told(group)
    assert outcome.first
    (finding,) = found["findings"]
    assert finding["form"] == "since"
    dates = [s["started_at"] for s in group.sessions]
    assert abs(dates.index(finding["since"]) - group.truths[0].since) <= 2


@pytest.mark.slow
def test_two_effects_are_two_findings():
    outcome, _ = told(draw_group("unit", "two", (7, 3)))
    assert outcome.named == (True, True)


def test_nothing_is_named_where_there_is_nothing():
    outcomes = [told(draw_group(level, "none", (33, k), size=8))[0] for k, level in enumerate(("unit", "stand"))]
    assert [o.findings for o in outcomes] == [(), ()]


def test_what_the_catalogue_lacks_is_unexplained():
    outcome, _ = told(draw_group("unit", "outside", (8, 1)))
    assert outcome.unexplained
    assert outcome.findings == ()


@pytest.mark.slow
@pytest.mark.parametrize(("form", "seed"), [("a²·T", 0), ("lag T·t", 1)])
def test_no_name_is_sure_where_the_effect_is_in_no_catalogue(form: str, seed: int):
    """Square of input times temperature, lagged temperature times time."""
    outcome, found = told(draw_group("unit", form, (27, seed), size=10))
    assert not outcome.sure, (outcome.findings, found["notes"])
    assert outcome.crowd <= 1, outcome.findings
    assert all(term["gain"] > 0 for term in found["terms"])


@pytest.mark.slow
def test_two_causes_on_one_sensor_are_still_two_names():
    outcome, found = told(draw_group("unit", "two", (27, 4, 0)))
    assert outcome.named == (True, True), (outcome.findings, found["notes"])


def test_misstated_noise_names_nothing():
    outcome, found = told(draw_group("unit", "none", (34, 1), size=10, misstated=True))
    assert outcome.findings == (), found["notes"]
