"""The pages that explain the service: help, the reference of its API, its settings."""

import re
from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.pages.help import WORDS, reference_page, settings_page
from service.settings import Origin, Settings
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.project.source import ROOT

GLOSSARY = (ROOT / "docs" / "glossary.md").read_text("utf-8")


SHARED = ("block", "reference", "epoch", "margin", "cause", "baseline")
"""Words of the pages that the glossary has too."""


@pytest.mark.parametrize("word", SHARED)
def test_a_word_means_what_the_glossary_says(word: str) -> None:
    assert f"| {word} | {dict(WORDS)[word]} |" in GLOSSARY


def test_the_glossary_has_few_words_and_no_other_of_the_pages() -> None:
    terms = re.findall(r"^\| ([^|]+) \|", GLOSSARY.split("## Terms")[1].split("## Verdicts")[0], re.MULTILINE)[2:]
    assert len(terms) <= 20
    assert set(terms) & set(dict(WORDS)) == set(SHARED)


def test_help_says_what_to_do_and_leads_on(client: httpx.Client) -> None:
    page = client.get("/help").text
    assert page.index("A unit is unfit") < page.index("Superseded") < page.index("arcsec")
    for path in ("/api-reference", "/settings"):
        assert f'href="{path}"' in page
        assert client.get(path).status_code == 200


def test_the_reference_has_every_call_and_leads_to_every_document(settings: Settings) -> None:
    described = create_app(settings).openapi()
    page = reference_page(described)
    calls = [(call.method.lower(), call.path) for section in page.sections for call in section.calls]
    assert sorted(calls) == sorted((m, path) for path, operations in described["paths"].items() for m in operations)
    named = {schema.name for schema in page.schemas}
    fields = [field for schema in page.schemas for field in schema.fields]
    fields += [field for section in page.sections for call in section.calls for field in call.fields]
    answers = {a.schema for section in page.sections for call in section.calls for a in call.answers}
    assert ({field.schema for field in fields} | answers) - {""} <= named
    assert len({call.anchor for section in page.sections for call in section.calls}) == len(calls)


def test_a_call_says_its_role_its_fields_and_what_it_answers(settings: Settings) -> None:
    page = reference_page(create_app(settings).openapi())
    calls = {(call.method, call.path): call for section in page.sections for call in section.calls}
    units = calls["GET", "/api/v1/units"]
    assert units.role == "viewer"
    assert {"order", "backwards"} <= {field.name for field in units.fields}
    assert [(answer.status, answer.schema) for answer in units.answers] == [
        ("200", "UnitPage"), ("503", "ProblemDocument"),
    ]  # fmt: skip


def test_settings_say_where_they_come_from(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMU_HEALTH_PORT", "8123")
    monkeypatch.setenv("IMU_HEALTH_STOP_SECONDS", "50")
    rows = {row.variable: row for row in settings_page(Settings(stop_seconds=77)).rows}
    shown = [(rows[f"IMU_HEALTH_{name}"].value, rows[f"IMU_HEALTH_{name}"].origin) for name in ("PORT", "STOP_SECONDS")]
    assert shown == [("8123", "environment"), ("77", "option at the start")]
    assert (rows["IMU_HEALTH_HOST"].value, rows["IMU_HEALTH_HOST"].origin) == ("127.0.0.1", "default")
    assert Settings(host="::1").origin_of("host") is Origin.START


@pytest.mark.parametrize("password", ["s3cr3t", "s3c/r3t", "p?s3cr3t", "s3cr3t#"])
def test_no_secret_is_shown(password: str) -> None:
    key = Path("/run/secrets/seal")
    given = Settings(
        database_url=f"postgresql://imu:{password}@db/health?sslpassword=s3cr3t",
        metrics_token="s3cr3t-of-metrics-",
        seal_password_file=key,
        oidc_client_secret_file=key,
    )
    page = settings_page(given)
    assert [row.variable for row in page.rows if "s3c" in row.value or "r3t" in row.value] == []
    rows = {row.variable: row for row in page.rows}
    assert rows["IMU_HEALTH_METRICS_TOKEN"].value == "set, not shown"
    assert rows["IMU_HEALTH_DATABASE_URL"].value == "postgresql+psycopg://imu:***@db/health"
    assert rows["IMU_HEALTH_SEAL_PASSWORD_FILE"].origin == "option at the start, from a file"
