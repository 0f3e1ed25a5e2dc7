"""docs/how-to/add-a-yes-or-no.md, followed: said with a file, said later, shown, in six files."""

import re
from pathlib import Path

import httpx
import pytest

from tests.how_to.follow import COPIED, PROJECT, House, followed
from tests.service.made_sessions import session_bytes

VERSIONS = PROJECT / "migrations" / "versions"
SAID = {"by": "K. Ito", "why": "flies on Monday"}


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> House:
    """With the new column after the latest change of the schema that there is."""
    house = followed("add-a-yes-or-no", tmp_path_factory.mktemp("mark"))
    new = house.root / "migrations" / "versions" / "0100_urgent.py"
    latest = max(file.name[:4] for file in VERSIONS.glob("0*.py"))
    new.write_text(re.sub('down_revision = "[0-9]+"', f'down_revision = "{latest}"', new.read_text("utf-8")), "utf-8")
    return house


@pytest.fixture(scope="module")
def told(house: House) -> list[bool | str]:
    """What is known of three sessions: of a plain one, one that was said to be urgent, and one that is so no more."""
    with house.serving() as address, httpx.Client(base_url=address) as client:
        sessions = f"{address}/api/v1/sessions"
        plain = client.post(sessions, content=session_bytes()).raise_for_status().json()
        urgent = client.post(f"{sessions}?urgent=true", content=session_bytes(month=6)).raise_for_status().json()
        page = client.get(f"/sessions/{urgent['id']}").text
        client.put(f"{sessions}/{urgent['id']}/urgent", json=SAID | {"is_urgent": False}).raise_for_status()
        later = client.get(f"{sessions}/{urgent['id']}").json()
        client.post(f"/sessions/{plain['id']}/urgent", data=SAID | {"is_urgent": "true"}, headers={"Origin": address})
        return [plain["is_urgent"], urgent["is_urgent"], page, later["is_urgent"], client.get("/sessions").text]


def test_it_is_said_with_the_file_and_changed_later(told: list[bool | str]) -> None:
    assert (told[0], told[1], told[3]) == (False, True, False)


def test_it_stands_on_the_page_and_in_the_list(told: list[bool | str]) -> None:
    assert "This unit is wanted back soon." in str(told[2])
    assert str(told[4]).count('<span class="tag">urgent</span>') == 1


def test_six_files_change(house: House) -> None:
    changed = [file for part in COPIED for file in (house.root / part).rglob("*") if is_changed(house.root, file)]
    assert len(changed) == 6


def is_changed(root: Path, file: Path) -> bool:
    """Whether a file of the copy is new, or another than it was."""
    was = PROJECT / file.relative_to(root)
    return file.suffix in (".py", ".html") and (not was.exists() or was.read_bytes() != file.read_bytes())


def test_no_other_file_of_the_service_names_the_one_that_there_is() -> None:
    named = [
        file
        for file in (PROJECT / "service").rglob("*")
        if file.suffix in (".py", ".html") and "is_check" in file.read_text("utf-8")
    ]
    assert len(named) <= 6
