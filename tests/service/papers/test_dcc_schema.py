"""The Digital Calibration Certificate is valid by PTB's XML schema and by its Schematron rules."""

import json
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import httpx
import pytest
from dcclib.validation import SchematronValidator
from lxml import etree

from service.settings import Settings
from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, mixed_block, raw_log
from tests.databases import one_engine
from tests.service.diagnosed import send
from tests.service.made_sessions import session_bytes
from tests.service.papers.laboratory import LABORATORY, named, state_all
from tests.service.recordings import recording_bytes
from tests.service.turntable import alignment_bytes

SCHEMAS = Path(os.environ.get("IMU_HEALTH_SCHEMAS", Path(__file__).parents[4] / "shared" / "schema"))
XSD = SCHEMAS / "dcc" / "v3.3.0" / "dcc.xsd"
SCHEMATRON = SCHEMAS / "schematron" / "dcc.sch"
needs_schemas = pytest.mark.skipif(
    not XSD.exists(), reason=f"no schemas in {SCHEMAS}; set IMU_HEALTH_SCHEMAS to the folder that holds dcc/v3.3.0"
)
SESSIONS = {
    "accelerometers": accelerometer_block(),
    "gyros": gyro_block(),
    "mixed": mixed_block(),
    "orientations": arbitrary_orientations(),
    "raw": raw_log(),
    "turntable": json.loads(alignment_bytes()),
}


@cache
def schema() -> etree.XMLSchema:
    """PTB's schema with all that it imports, read offline."""
    return etree.XMLSchema(etree.parse(XSD, etree.XMLParser(no_network=True)))


@cache
def rules() -> tuple[SchematronValidator, ...]:
    """PTB's rules: those that come with its library, and those of the schemas at hand."""
    own = SchematronValidator.for_dcc()
    return (own, SchematronValidator.from_file(str(SCHEMATRON))) if SCHEMATRON.exists() else (own,)


def broken(content: bytes) -> list[tuple[str, str]]:
    """Every rule that is broken or warned of, with its text."""
    results = [rule.validate_str(content.decode()) for rule in rules()]
    found = [report for result in results for report in (*result.failed_assertions, *result.successful_reports)]
    return [(report.role, report.text) for report in found if report.role != "information"]


def dcc(client: httpx.Client, id: str) -> bytes:
    """The certificate as XML."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate?format=dcc")
    assert answer.status_code == 200, answer.text
    return answer.content


@pytest.fixture
def laboratory(settings: Settings) -> Iterator[httpx.Client]:
    """An empty service whose operator has set everything."""
    with named(settings) as client:
        yield client


@one_engine
@pytest.mark.parametrize("name", SESSIONS)
def test_every_programme_keeps_ptb_s_rules_and_is_valid_by_the_schema(laboratory: httpx.Client, name: str) -> None:
    content = dcc(laboratory, send(laboratory, SESSIONS[name]))
    assert broken(content) == []
    if XSD.exists():
        assert schema().validate(etree.fromstring(content)), schema().error_log


@one_engine
@needs_schemas
def test_one_that_replaces_another_is_valid_too(laboratory: httpx.Client) -> None:
    laboratory.post("/api/v1/sessions", content=session_bytes()).raise_for_status()
    id = laboratory.post("/api/v1/sessions", content=session_bytes(seed=2, month=5)).json()["id"]
    dcc(laboratory, id)
    state_all(laboratory, valid_until="2026-04-01")
    content = dcc(laboratory, id)
    assert b"substituted" in content
    assert schema().validate(etree.fromstring(content)), schema().error_log
    assert broken(content) == []


@one_engine
@needs_schemas
def test_a_recording_in_service_is_valid_too(laboratory: httpx.Client) -> None:
    laboratory.post("/api/v1/sessions", content=session_bytes()).raise_for_status()
    content = dcc(laboratory, laboratory.post("/api/v1/sessions", content=recording_bytes()).json()["id"])
    assert schema().validate(etree.fromstring(content)), schema().error_log
    assert broken(content) == []


@one_engine
def test_without_a_country_the_rules_refuse_it_and_nothing_else(settings: Settings) -> None:
    assert LABORATORY["laboratory_country"] == "DE"
    with named(settings, laboratory_country="") as client:
        content = dcc(client, send(client, SESSIONS["accelerometers"]))
    assert {role for role, _ in broken(content)} == {"error"}
    assert all("country code" in text for _, text in broken(content))


@one_engine
@needs_schemas
def test_a_fault_would_be_seen(laboratory: httpx.Client) -> None:
    content = dcc(laboratory, send(laboratory, SESSIONS["accelerometers"]))
    assert not schema().validate(etree.fromstring(content.replace(b"issueDate", b"issueDay")))
    assert broken(content.replace(b"<dcc:release>v", b"<dcc:release>"))
