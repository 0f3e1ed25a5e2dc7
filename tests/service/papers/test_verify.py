"""A stranger computes every number of a certificate again, and whatever somebody changed in it is refused."""

import os
import subprocess
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import pytest
from lxml import etree

from service.papers import sealing
from service.papers.dcc.digest import parsed
from service.papers.dcc.elements import NAMESPACES
from service.papers.sealing import Seal, seal_of
from service.papers.verifying import again
from service.papers.verifying.records import Outcome, RawFile, Verification
from service.papers.verifying.verify import Beside, verify
from tests.conftest import Holding, SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.commands.conftest import (
    COMMAND,
    Run,
    run,  # noqa: F401 - a fixture
)
from tests.service.diagnosed import ECCENTRIC, accepted, held
from tests.service.faulty_recordings import faulty_bytes
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.laboratory import named, state_all
from tests.service.papers.mutations import anew, mutated
from tests.service.papers.trial_key import trial_key
from tests.service.recordings import recording_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
ID = session_id(FAILED[-1])
RAW = RawFile("session.json", FAILED[-1])
MUTATIONS = 30
NOTHING = Beside()


def certificate(client: httpx.Client, id: str = ID) -> bytes:
    """The certificate as XML."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate?format=dcc")
    answer.raise_for_status()
    return answer.content


def raw(client: httpx.Client, id: str) -> RawFile:
    """The file of a certificate's session."""
    return RawFile("session.json", client.get(f"/api/v1/sessions/{id}/file").content)


def outcomes(found: Verification) -> dict[str, Outcome]:
    return {check.subject: check.outcome for check in found.checks}


@pytest.fixture(scope="module")
def key_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Key and certificate for trial."""
    file = tmp_path_factory.mktemp("seal") / "seal.pem"
    file.write_bytes(trial_key("Laboratory North", datetime.now(UTC)))
    return file


@pytest.fixture
def seal(key_file: Path) -> Seal:
    """Seal of that key."""
    found = seal_of(key_file, None)
    assert found is not None
    return found


@pytest.fixture
def trusted(key_file: Path) -> bytes:
    """The certificate of the key."""
    return b"-----BEGIN CERTIFICATE" + key_file.read_bytes().split(b"-----BEGIN CERTIFICATE")[1]


@pytest.fixture
def client(settings_holding: SettingsHolding) -> Iterator[httpx.Client]:
    """HTTP to a laboratory that states everything, with a reference and a session out of tolerance."""
    with named(settings_holding(*FAILED, diagnosed=True)) as http:
        state_all(http)
        yield http


@pytest.fixture
def printed(client: httpx.Client) -> bytes:
    """The certificate of the session out of tolerance."""
    return certificate(client)


def test_reference_judged_session_and_recording_agree(client: httpx.Client) -> None:
    recording = client.post("/api/v1/sessions", content=recording_bytes()).json()["id"]
    later = faulty_bytes("stuck").replace(b"2026-05-01T", b"2026-05-02T")
    faulty = client.post("/api/v1/sessions", content=later).json()["id"]
    for id in (session_id(FAILED[0]), ID, recording, faulty):
        found = verify(certificate(client, id), raw(client, id), NOTHING, NOW)
        assert found.outcome is Outcome.AGREES, found


def test_one_with_an_accepted_cause_agrees(holding: Holding) -> None:
    client, id = held(holding, ECCENTRIC)
    accepted(client, id)
    found = verify(certificate(client, id), raw(client, id), NOTHING, NOW)
    assert found.outcome is Outcome.AGREES, found


def test_the_reference_s_own_file_is_computed_again_too(printed: bytes) -> None:
    beside = Beside(reference=RawFile("reference.json", FAILED[0]))
    assert outcomes(verify(printed, RAW, beside, NOW))["reference"] is Outcome.AGREES
    other = Beside(reference=RAW)
    assert outcomes(verify(printed, RAW, other, NOW))["reference"] is Outcome.DIFFERS


def test_a_difference_says_what_is_printed_and_what_is_computed(printed: bytes) -> None:
    root = parsed(printed)
    path = "//dcc:result[dcc:name/dcc:content='accelerometer A3']//dcc:quantity[dcc:name/dcc:content='bias']//si:value"
    [bias] = root.xpath(path, namespaces=NAMESPACES)
    was, bias.text = bias.text, "0.5"
    found = verify(anew(root), RAW, NOTHING, NOW)
    [says] = [line for check in found.checks if check.outcome is Outcome.DIFFERS for line in check.says]
    assert says.endswith(f"accelerometer A3 › bias › value: printed 0.5, computed {was}")


def once(step: Callable[..., Any]) -> Callable[..., Any]:
    """Answers every call with the step's first result: no change touches what it rests on, and many would take long."""
    made = list[Any]()

    def answered(*given: Any, **named: Any) -> Any:
        made[:] = made or [step(*given, **named)]
        return made[0]

    return answered


def test_whatever_is_changed_is_refused(
    printed: bytes, seal: Seal, trusted: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    sealed, beside = seal.xml(printed), Beside(trusted=trusted)
    for name in ("calibrate", "judge"):
        monkeypatch.setattr(again, name, once(getattr(again, name)))
    assert verify(sealed, RAW, beside, NOW).outcome is Outcome.AGREES
    passed = [
        seed
        for seed in range(MUTATIONS)
        if verify(mutated(sealed, seed), RAW, beside if seed % 2 else NOTHING, NOW).outcome is not Outcome.DIFFERS
    ]
    assert passed == []


@pytest.mark.parametrize(("reference", "calibrations"), [(None, 1), (RawFile("r.json", FAILED[0]), 2)])
def test_each_file_is_calibrated_and_the_session_judged_once(
    printed: bytes, monkeypatch: pytest.MonkeyPatch, reference: RawFile | None, calibrations: int
) -> None:
    called = list[str]()
    for name in ("calibrate", "judge"):
        monkeypatch.setattr(again, name, counted(getattr(again, name), called))
    assert verify(printed, RAW, Beside(reference=reference), NOW).outcome is Outcome.AGREES
    assert sorted(called) == ["calibrate"] * calibrations + ["judge"]


def counted(step: Callable[..., Any], called: list[str]) -> Callable[..., Any]:
    """The step, with its name noted at every call."""

    def answered(*given: Any, **named: Any) -> Any:
        called.append(step.__name__)
        return step(*given, **named)

    return answered


def test_a_seal_of_somebody_else_is_refused(printed: bytes, seal: Seal, tmp_path: Path) -> None:
    (tmp_path / "other.pem").write_bytes(trial_key("Somebody", datetime.now(UTC)))
    other = (tmp_path / "other.pem").read_bytes()
    own = b"-----BEGIN CERTIFICATE" + other.split(b"-----BEGIN CERTIFICATE")[1]
    assert outcomes(verify(seal.xml(printed), RAW, Beside(trusted=own), NOW))["seal"] is Outcome.DIFFERS
    unknown = verify(seal.xml(printed), RAW, NOTHING, NOW)
    assert unknown.outcome is Outcome.AGREES
    assert any("To check that it is the laboratory's" in line for c in unknown.checks for line in c.says)


def test_without_the_library_of_seals_it_says_so(printed: bytes, seal: Seal, monkeypatch: pytest.MonkeyPatch) -> None:
    sealed = seal.xml(printed)
    monkeypatch.setattr(sealing, "ROOM", "service.papers.no_such_room")
    found = verify(sealed, RAW, NOTHING, NOW)
    [own] = [check for check in found.checks if check.subject == "seal"]
    assert (found.outcome, own.outcome) == (Outcome.NOT_CHECKED, Outcome.NOT_CHECKED)
    assert "Run pip install" in own.says[0]


def test_one_of_an_earlier_release_says_that_it_cannot_be_computed_again(printed: bytes) -> None:
    root = parsed(printed)
    for element in root.xpath("//dcc:document | //dcc:coreData//dcc:identification[last()]", namespaces=NAMESPACES):
        element.getparent().remove(element)
    found = verify(etree.tostring(root), RAW, NOTHING, NOW)
    assert found.outcome is Outcome.NOT_CHECKED
    assert {outcomes(found)[subject] for subject in ("numbers", "contents")} == {Outcome.NOT_CHECKED}


def test_the_command_s_exit_code_says_it(run: Run, printed: bytes, tmp_path: Path) -> None:  # noqa: F811
    (tmp_path / "c.xml").write_bytes(printed)
    (tmp_path / "s.json").write_bytes(FAILED[-1])
    (tmp_path / "other.json").write_bytes(session_bytes(seed=7))
    agreed = run("verify", tmp_path / "c.xml", tmp_path / "s.json", "--json")
    assert (agreed.code, agreed.documents[0]["outcome"]) == (0, "agrees")
    other = run("verify", tmp_path / "c.xml", tmp_path / "other.json")
    assert (other.code, "is another file" in other.out) == (1, True)
    assert run("verify", tmp_path / "s.json", tmp_path / "s.json").code == 2
    assert run("verify", tmp_path / "c.xml", tmp_path / "s.json", "--schema", tmp_path).code == 2
    assert run("verify", tmp_path / "none.xml", tmp_path / "s.json").code == 2


@pytest.mark.slow
def test_another_build_of_the_linear_algebra_agrees(printed: bytes, tmp_path: Path) -> None:
    """The other build is for a processor without wide registers, which every other one can run."""
    (tmp_path / "c.xml").write_bytes(printed)
    (tmp_path / "s.json").write_bytes(FAILED[-1])
    environment = os.environ | {"OPENBLAS_CORETYPE": "Prescott"}
    subprocess.run([COMMAND, "verify", "c.xml", "s.json"], cwd=tmp_path, env=environment, check=True)
