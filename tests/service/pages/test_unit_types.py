"""The pages of unit types: what is allowed and who allowed it, the nominal model, and the units."""

import json
from dataclasses import replace

import httpx
import pytest

from service.fleet.use import Use
from service.pages.type.pages import TypeLine, TypeReport, type_page, types_page
from service.types.records import ToleranceRevision, Tolerances, UnitType
from tests.builders import mixed_block
from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.service.pages.records import NOON

TOLERANCES = {"scale": 5e-5, "bias": 4e-4, "quadratic": None, "axis": 1e-4}
G = 9.80665
KIND = UnitType(
    "RA-6", "accelerometer", ("A1",), ((0.0, 1.0, 0.0),), (0.12,), Tolerances(1e-4, 50e-6 * G, None, 1e-4), None, 2
)


def line(known: UnitType = KIND, **counts: int) -> TypeLine:
    """A type with units of each answer."""
    return TypeLine(known, sum(counts.values()), {Use[name.upper()]: count for name, count in counts.items()})


def test_a_type_is_listed_with_its_limits_and_the_units_that_must_not_be_used_first() -> None:
    [row] = types_page([line(yes=2, no=1)]).rows
    assert (row.block, row.units) == ("1 accelerometer", 3)
    assert [(one.words, one.count) for one in row.counts] == [("must not be used", 1), ("may be used", 2)]
    assert row.counts[0].url == "/?use=no&type=RA-6"
    assert row.tolerances == ("Scale factor ±100\u202fppm", "Bias ±50\u202fµg", "Input axis 20.63\u202farcsec")


def test_the_first_tolerances_are_the_service_s_own() -> None:
    revisions = tuple(ToleranceRevision(n, NOON, KIND.tolerances, None) for n in (1, 2))
    report = TypeReport(line(no=1), {}, revisions[:1], {}, (), (), {}, ())
    assert "the service itself" in type_page(report).revisions[0].who
    report = TypeReport(line(no=1), {}, revisions[1:], {NOON: "K. Ito"}, (), (), {}, ())
    assert type_page(report).revisions[0].who == "K. Ito"


def test_a_type_s_page_says_who_changed_its_tolerances(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes(unit_type="RA/6"))
    assert "set by the service itself" in client.get("/unit-types/RA/6").text
    client.put("/api/v1/unit-types/RA/6", json={"tolerances": TOLERANCES}).raise_for_status()
    page = client.get("/unit-types/RA/6").text
    assert "Revision 2, since" in page
    assert "set by crew" in page
    assert "Every revision" in page
    assert '<a href="/units/BA-017">BA-017</a>' in page
    assert '<a href="/unit-types/RA/6">RA/6</a>' in client.get("/unit-types").text
    assert '<a href="/unit-types/RA/6">RA/6</a>' in client.get("/units/BA-017").text
    assert client.get("/unit-types/none").status_code == 404


def test_a_mixed_block_s_sensors_have_the_kinds_that_a_session_told(holding: Holding) -> None:
    page = holding(json.dumps(mixed_block() | {"unit_type": "MX"}).encode()).get("/unit-types/MX").text
    assert page.count('<td data-label="Kind">accelerometer</td>') == 3
    assert page.count('<td data-label="Kind">gyro</td>') == 3
    assert "per °/s" in page


def test_a_block_of_gyros_with_accelerometers_shows_what_each_is_judged_by() -> None:
    gyros = Tolerances(1e-3, 2e-7, None, 1e-4)
    mixed = replace(KIND, block="gyroscope", tolerances=gyros, gyro_tolerances=gyros)
    [row] = types_page([line(mixed, no=1)]).rows
    assert "Bias, accelerometers ±50\u202fµg" in row.tolerances
    assert "Bias, gyros ±0.04125\u202f°/h" in row.tolerances


@one_engine
@pytest.mark.parametrize(("path", "said"), [("/stands", "on a stand yet"), ("/unit-types", "No unit type yet")])
def test_an_empty_service_says_so(client: httpx.Client, path: str, said: str) -> None:
    assert said in client.get(path).text
