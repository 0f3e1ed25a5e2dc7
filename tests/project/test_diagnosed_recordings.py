"""The pages on real recordings are made by their command; one of them, cheaply."""

from pathlib import Path

import pytest

from benchmarks.diagnosed_recordings.pages import index, page
from benchmarks.diagnosed_recordings.subjects import PAGES, diagnosed
from benchmarks.recordings.sets import folder

PUBLISHED = Path(__file__).parents[2] / "docs" / "diagnosis"


@pytest.mark.parametrize("name", PAGES)
def test_every_recording_has_its_page_and_its_place_in_the_index(name: str) -> None:
    assert (PUBLISHED / "recordings" / f"{name}.md").is_file()
    assert f"recordings/{name}.md" in (PUBLISHED / "recordings.md").read_text()


@pytest.mark.slow
def test_the_page_of_one_recording_is_made(tmp_path: Path) -> None:
    if not folder().is_dir():
        pytest.skip(f"no recordings in {folder()}; set IMU_HEALTH_RECORDINGS to their folder")
    made = diagnosed("imu-tk")
    page("imu-tk", made, tmp_path)
    assert "**`g-sensitivity`**" in (tmp_path / "imu-tk-in-full.md").read_text()
    assert "![measured minus simulated](imu-tk-1.png)" in (tmp_path / "imu-tk.md").read_text()
    assert (tmp_path / "imu-tk-1.png").read_bytes().startswith(b"\x89PNG")
    assert "[imu-tk-xsens-mti](recordings/imu-tk.md)" in index({"imu-tk": made})
