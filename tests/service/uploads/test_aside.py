"""Tables that are set aside until it is said how they are read."""

from pathlib import Path

from service.kit.arriving_files import held
from service.storage import Files
from service.storage.aside import FOLDER, aside, set_aside
from service.storage.files import content_hash
from tests.service.made_records import NOW


def test_a_table_that_is_removed_meanwhile_hinders_no_other(tmp_path: Path) -> None:
    files = Files(tmp_path)
    first = set_aside(files, "ito", b"a table", NOW)
    (tmp_path / FOLDER / "removed").symlink_to(tmp_path / "nowhere")  # listed, and gone when it is looked at
    assert aside(files, "ito", first, NOW) is not None
    second = set_aside(files, "ito", b"another", NOW)
    found = aside(files, "ito", second, NOW)
    assert found is not None
    assert (held(found), found.sha256, len(found)) == (b"another", content_hash(b"another"), len(b"another"))
