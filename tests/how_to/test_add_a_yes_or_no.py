"""docs/how-to/add-a-yes-or-no.md, followed: said with a file, said later, shown, in six files."""

from pathlib import Path

import pytest

from tests.how_to.conftest import Served
from tests.how_to.follow import COPIED, PROJECT, House, followed
from tests.service.made_sessions import session_bytes

SAID = {"by": "K. Ito", "why": "flies on Monday"}


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> House:
    """The source with the page's mark."""
    return followed(tmp_path_factory.mktemp("mark"), "add-a-yes-or-no")


@pytest.fixture(scope="module")
def answers(served: Served) -> list[bool | str]:
    """Answers about three sessions: a plain one, one stated to be urgent, and one that is urgent no more."""
    client, sessions, address = served.http, "/api/v1/sessions", str(served.http.base_url).rstrip("/")
    first, second = (session_bytes(unit="HURRIED", month=month) for month in (3, 6))
    plain = client.post(sessions, content=first).raise_for_status().json()
    urgent = client.post(f"{sessions}?urgent=true", content=second).raise_for_status().json()
    page = client.get(f"/sessions/{urgent['id']}").text
    client.put(f"{sessions}/{urgent['id']}/urgent", json=SAID | {"is_urgent": False}).raise_for_status()
    later = client.get(f"{sessions}/{urgent['id']}").json()
    client.post(f"/sessions/{plain['id']}/urgent", data=SAID | {"is_urgent": "true"}, headers={"Origin": address})
    return [plain["is_urgent"], urgent["is_urgent"], page, later["is_urgent"], client.get("/sessions").text]


def test_it_is_said_with_the_file_and_changed_later(answers: list[bool | str]) -> None:
    assert (answers[0], answers[1], answers[3]) == (False, True, False)


def test_it_stands_on_the_page_and_in_the_list(answers: list[bool | str]) -> None:
    assert "This unit is wanted back soon." in str(answers[2])
    assert str(answers[4]).count('<span class="tag">urgent</span>') == 1


def test_six_files_change(house: House) -> None:
    changed = [file for part in COPIED for file in (house.root / part).rglob("*") if is_changed(house.root, file)]
    assert len(changed) == 6


def is_changed(root: Path, file: Path) -> bool:
    """Whether a file of the copy is new or changed."""
    was = PROJECT / file.relative_to(root)
    return file.suffix in (".py", ".html") and (not was.exists() or was.read_bytes() != file.read_bytes())


def test_no_other_file_of_the_service_names_the_one_that_there_is() -> None:
    named = [
        file
        for file in (PROJECT / "service").rglob("*")
        if file.suffix in (".py", ".html") and "is_check" in file.read_text("utf-8")
    ]
    assert len(named) <= 6
