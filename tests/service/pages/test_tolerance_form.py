"""Tolerances of a unit type are set on its page, in people's measures."""

import httpx
import pytest
from lxml import html

from tests.conftest import Holding
from tests.service.made_sessions import session_bytes

TYPE = "/unit-types/accelerometer × 6, V"
SAID = {"by": "M. Okafor", "why": "the customer asks for more", "seen": "1"}


@pytest.fixture
def typed(holding: Holding) -> httpx.Client:
    """A service with one unit of one type."""
    return holding(session_bytes())


def shown(client: httpx.Client) -> dict[str, str]:
    """Fields of the form, for the sessions to come only."""
    form = html.fromstring(client.get(TYPE).text).xpath("//form[contains(@action, '/tolerances')]")[0]
    return {str(name): str(value) for name, value in form.fields.items() if name != "stored"}


def stored(client: httpx.Client) -> dict[str, object]:
    found: dict[str, object] = client.get(f"/api/v1{TYPE}").json()
    return found


def test_one_number_is_changed_and_the_others_stay_to_the_last_digit(typed: httpx.Client) -> None:
    before = stored(typed)
    form = shown(typed) | SAID | {"accelerometer.bias": "40,5"}
    answer = typed.post(f"{TYPE}/tolerances", data=form)
    assert answer.status_code == 303
    after = stored(typed)
    assert after["revision"] == 2
    assert after["tolerances"] == before["tolerances"] | {"bias": pytest.approx(40.5e-6 * 9.80665)}  # type: ignore[operator]
    line = typed.get("/api/v1/audit").json()["lines"][0]
    assert (line["action"], line["who"], line["details"]["why"]) == ("tolerances", "M. Okafor", SAID["why"])
    assert "set by M. Okafor" in typed.get(TYPE).text


def test_an_unchanged_form_changes_nothing(typed: httpx.Client) -> None:
    before = stored(typed)
    typed.post(f"{TYPE}/tolerances", data=shown(typed) | SAID)
    assert stored(typed) == before


def test_an_empty_field_is_not_judged_and_the_interval_holds(typed: httpx.Client) -> None:
    typed.post(f"{TYPE}/tolerances", data=shown(typed) | SAID | {"accelerometer.quadratic": "", "interval": "200"})
    after = stored(typed)
    assert after["tolerances"]["quadratic"] is None  # type: ignore[index]
    assert after["maximum_interval_days"] == 200


def test_the_share_that_has_a_flag_is_set_for_all_units_at_once_and_kept_in_the_audit_trail(
    typed: httpx.Client,
) -> None:
    assert shown(typed)["share"] == "30"
    typed.post(f"{TYPE}/tolerances", data=shown(typed) | SAID | {"share": "12,5"})
    assert (stored(typed)["flag_share"], stored(typed)["revision"]) == (0.125, 1)
    line = typed.get("/api/v1/audit").json()["lines"][0]
    assert (line["action"], line["details"]["before"], line["details"]["flag_share"]) == ("flag share", 0.3, 0.125)


def test_every_number_that_is_none_is_told(typed: httpx.Client) -> None:
    wrong = {"accelerometer.bias": "many", "accelerometer.axis": "-3", "interval": "0", "share": "130"}
    answer = typed.post(f"{TYPE}/tolerances", data=shown(typed) | SAID | wrong)
    assert answer.status_code == 422
    assert {p["field"] for p in answer.json()["problems"]} == set(wrong)
    assert stored(typed)["revision"] == 1


def test_what_somebody_set_meanwhile_is_not_overwritten(typed: httpx.Client) -> None:
    form = shown(typed) | SAID
    for bias, status in (("41", 303), ("42", 409)):
        assert typed.post(f"{TYPE}/tolerances", data=form | {"accelerometer.bias": bias}).status_code == status
