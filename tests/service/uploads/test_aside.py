"""Tables that are set aside until it is said how they are read."""

from pathlib import Path

from service.storage import Files
from service.storage.aside import FOLDER, aside, set_aside
from tests.service.made_records import NOW


def test_a_table_that_is_removed_meanwhile_hinders_no_other(tmp_path: Path) -> None:
    files = Files(tmp_path)
    first = set_aside(files, "ito", b"a table", NOW)
    (tmp_path / FOLDER / "removed").symlink_to(tmp_path / "nowhere")  # listed, and gone when it is looked at
    assert aside(files, "ito", first, NOW) == b"a table"
    second = set_aside(files, "ito", b"another", NOW)
    assert aside(files, "ito", second, NOW) == b"another"
