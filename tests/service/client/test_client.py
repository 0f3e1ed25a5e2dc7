"""The typed client against a real service, from upload to certificate."""

import re
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest

from service.app import create_app
from service.client import Client, connect
from service.client.answers import Point, read
from service.errors import ConflictError, NotFoundError, RefusedError, ServiceError, SignInError
from service.kit.person import Role
from service.settings import Settings
from tests.conftest import SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - a hook
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.people.staff import NOW, staffed
from tests.serving import running, serving
from tests.stock import stores

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture
def address(settings_holding: SettingsHolding) -> Iterator[str]:
    """A service with a unit out of tolerance."""
    with serving(settings_holding(*FAILED)) as url:
        yield url


@pytest.fixture
def client(address: str) -> Iterator[Client]:
    """A client of it."""
    with connect(address) as found:
        yield found


def test_an_upload_is_answered_once_it_is_diagnosed(client: Client, tmp_path: Path) -> None:
    file = tmp_path / "next.json"
    file.write_bytes(session_bytes(seed=3, month=5))
    stored = client.upload(file)
    session = client.verdict_of(stored.id)
    assert (stored.created, stored.unit, session.verdict, session.said) == (True, "BA-017", "pass", "Fit")
    assert session.started_at == datetime(2026, 5, 1, 9, tzinfo=UTC)
    assert client.upload(file.read_bytes()).created is False


def test_a_refused_file_is_an_error_with_every_problem(client: Client) -> None:
    with pytest.raises(RefusedError, match="Nothing was stored") as caught:
        client.upload(session_bytes(block="thermometer", unit=""))
    assert {"block", "unit"} <= {problem.field for problem in caught.value.problems}


def test_a_history_comes_typed_and_whole(client: Client, address: str) -> None:
    points = list(client.history("BA-017", since=datetime(2026, 2, 1, tzinfo=UTC)))
    told = httpx.get(f"{address}/api/v1/units/BA-017/history?since=2026-02-01").json()["points"]
    assert [point.document for point in points] == told
    (axis, *_), (bias, *_) = ([p for p in points if p.parameter == name] for name in ("axis", "bias"))
    assert (len(axis.axis or ()), bias.axis, bias.at.month) == (3, None, 2)


def test_pages_follow_one_another(client: Client) -> None:
    assert len({flag.id for flag in client.flags()}) == len(list(client.flags())) > 0
    assert [unit.serial for unit in client.units(limit=1)] == ["BA-017"]
    client.upload(session_bytes(unit="BA 018/7"))
    assert [unit.serial for unit in client.units(limit=1)] == ["BA-017", "BA 018/7"]
    assert client.unit("BA 018/7").is_reference


def test_the_diagnosis_names_what_it_found(client: Client) -> None:
    found = client.diagnosis(session_id(FAILED[1]))
    assert found.document["format"] == "imu-diagnosis/1"
    assert all(finding.cause in finding.document["cause"] for finding in found.findings)
    assert found.summary


def test_whether_a_unit_may_be_used_is_said_with_its_reasons(client: Client) -> None:
    answer = client.usable("BA-017")
    assert (answer.usable, answer.session) == (False, session_id(FAILED[1]))
    assert answer.why in answer.reasons


def test_a_flag_is_resolved_once(client: Client) -> None:
    (flag, *_) = client.flags(unit="BA-017", state="raised")
    assert client.acknowledge(flag.id, by="K. Ito", why="ordered").state == "acknowledged"
    assert client.resolve(flag.id, by="K. Ito", why="replaced").state == "resolved"
    with pytest.raises(ConflictError, match="resolved"):
        client.resolve(flag.id, by="K. Ito", why="again")


def test_a_certificate_comes_as_bytes_for_people_or_programs(client: Client) -> None:
    assert client.certificate(session_id(FAILED[1]), by="K. Ito").startswith(b"%PDF")
    assert b"digitalCalibrationCertificate" in client.certificate(session_id(FAILED[1]), "dcc")


def test_what_is_not_there_is_said_in_the_service_s_words(client: Client) -> None:
    with pytest.raises(NotFoundError, match="There is no unit 'none'"):
        client.unit("none")


def test_nobody_answers(client: Client) -> None:
    with connect("http://127.0.0.1:1") as nobody, pytest.raises(ServiceError, match="does not answer"):
        nobody.usable("BA-017")


def test_the_token_comes_from_the_environment(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    with stores(settings) as storage:
        token = staffed(storage).tokens[Role.VIEWER]
    with running(create_app(settings.model_copy(update={"sign_in": "required"}), clock=lambda: NOW)) as address:
        with connect(address) as nobody, pytest.raises(SignInError):
            list(nobody.units())
        monkeypatch.setenv("IMU_HEALTH_TOKEN", token)
        with connect(address) as known:
            assert list(known.units()) == []


def test_an_answer_of_another_version_is_an_error_that_names_the_field() -> None:
    with pytest.raises(ServiceError, match=r"Point.*'session'"):
        read(Point, {"at": "2026-01-01T00:00:00Z"})


def test_a_field_that_came_later_is_passed_over_and_still_there(client: Client) -> None:
    (point, *_) = client.history("BA-017")
    assert read(Point, {**point.document, "new": 1}).document["new"] == 1


def test_the_client_loads_nothing_else_of_the_service() -> None:
    script = "import sys, service.client; print(*sys.modules)"
    seen = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "fastapi", "sqlalchemy", "polars", "pydantic", "service.settings"} & set(seen)


def test_the_lines_of_the_page_run(address: str, tmp_path: Path) -> None:
    (lines,) = re.findall(r"^```python\n(.*?)^```", (DOCS / "api.md").read_text("utf-8"), re.DOTALL | re.MULTILINE)
    (tmp_path / "BA-900-002.json").write_bytes(FAILED[1])
    own = [sys.executable, "-c", lines.replace("http://127.0.0.1:8000", address)]
    done = subprocess.run(own, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("BA-017 Unfit")
    assert (tmp_path / "certificate.pdf").read_bytes().startswith(b"%PDF")
