"""`imu-health calibrate`: what it prints, and its exit codes."""

from io import StringIO
from pathlib import Path

from rich.console import Console

from estimator import calibrate
from estimator.reading import read_session
from service.commands.calibrate import calibration_view
from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block
from tests.service.commands.conftest import Run, write


def test_one_file_with_json_gives_the_object(run: Run, good_file: Path) -> None:
    ran = run("calibrate", good_file, "--json")
    assert ran.code == 0
    assert ran.documents == [calibrate(read_session(good_file)).to_dict()]


def test_several_files_with_json_give_one_object_a_line_in_order(run: Run, tmp_path: Path) -> None:
    files = [write(tmp_path, f"{unit}.json", accelerometer_block(unit=unit)) for unit in ("C", "A", "B")]
    ran = run("calibrate", *files, "--json")
    assert ran.code == 0
    assert [document["unit"] for document in ran.documents] == ["C", "A", "B"]


def test_a_bad_file_names_every_field_and_row_on_one_line(run: Run, bad_file: Path) -> None:
    ran = run("calibrate", bad_file, "--json")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.count("\n") == 1
    for part in (str(bad_file), "A2, row 3", "stand.alpha_deg", "A4_se, row 5"):
        assert part in ran.err


def test_a_bad_file_does_not_stop_the_others(run: Run, good_file: Path, bad_file: Path) -> None:
    ran = run("calibrate", bad_file, good_file, "--json")
    assert ran.code == 2
    assert [document["unit"] for document in ran.documents] == ["BA-017"]


def test_every_bad_file_has_its_own_line(run: Run, bad_file: Path, tmp_path: Path) -> None:
    missing, folder = tmp_path / "missing.json", tmp_path
    ran = run("calibrate", missing, bad_file, folder)
    assert ran.code == 2
    *lines, last = ran.err.splitlines()
    assert [line.split(":")[0] for line in lines] == [str(missing), str(bad_file), str(folder)]
    assert last.startswith("3 of 3 files failed: ")


def test_a_line_break_in_a_name_does_not_break_the_line(run: Run, tmp_path: Path) -> None:
    file = write(tmp_path, "a\nb.json", {"format": "x\ny"})
    assert run("calibrate", file).err.count("\n") == 1


def test_a_wrong_option_is_not_unusable_input(run: Run, good_file: Path) -> None:
    ran = run("calibrate", good_file, "--jsonn")
    assert ran.code == 1
    assert "--jsonn" in ran.err


def test_the_table_shows_people_s_units_with_uncertainties(run: Run, good_file: Path) -> None:
    ran = run("calibrate", good_file)
    sensor = calibrate(read_session(good_file)).sensors[0]
    assert sensor.bias.value is not None
    bias = f"{abs(sensor.bias.value) / 9.80665e-6:.0f}"
    row = next(line for line in ran.out.splitlines() if line.startswith("A1 "))
    assert bias[:2] in row.replace("\u202f", "")
    assert all(unit in row for unit in ("ppm", "µg", "µg/g²", "arcsec", "±"))


def test_no_number_is_cut_off_on_a_narrow_terminal(good_file: Path) -> None:
    session = read_session(good_file)
    narrow = Console(width=80, file=StringIO())
    narrow.print(calibration_view(session, calibrate(session)))
    assert isinstance(narrow.file, StringIO)
    assert "…" not in narrow.file.getvalue()


def test_gyros_are_shown_in_degrees_an_hour(run: Run, tmp_path: Path) -> None:
    ran = run("calibrate", write(tmp_path, "gyro.json", gyro_block()))
    assert ran.code == 0
    assert "°/h" in ran.out


def test_what_is_not_observable_is_said_in_words(run: Run, tmp_path: Path) -> None:
    session = accelerometer_block(runs=("direct",))
    ran = run("calibrate", write(tmp_path, "one-run.json", session))
    assert ran.code == 0
    assert "not observable" in ran.out
    assert "this session does not observe" in ran.out


def test_how_model_and_readings_agree_is_said_in_words(run: Run, good_file: Path, tmp_path: Path) -> None:
    assert (
        "The model agrees with the readings; the stated noise is probably too large. χ² ="
        in run("calibrate", good_file).out
    )
    unstated = write(tmp_path, "unstated.json", arbitrary_orientations(se=None))
    assert "states no standard errors" in run("calibrate", unstated).out


def test_a_command_that_is_none_is_told_what_it_may_have_been(run: Run) -> None:
    ran = run("calibrat")
    assert ran.code == 1
    assert "'calibrate'" in ran.err


def test_a_csv_table_finds_its_metadata_in_the_json_file_beside_it(run: Run, tmp_path: Path) -> None:
    document = accelerometer_block()
    table = document.pop("table")
    write(tmp_path, "x.json", document)
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values(), strict=True))]
    (tmp_path / "x.csv").write_text("\n".join(lines), encoding="utf-8")
    ran = run("calibrate", tmp_path / "x.csv", "--json")
    assert ran.documents == [calibrate(read_session(accelerometer_block())).to_dict()]


def test_too_few_positions_are_said_with_how_many_to_add(run: Run, tmp_path: Path) -> None:
    """A triad in nine orientations, no standard errors: the parameters take all that the readings tell."""
    ran = run("calibrate", write(tmp_path, "few.json", arbitrary_orientations(3, orientations=9, se=None)))
    assert ran.code == 0
    assert "Too few positions for an uncertainty: add 5" in " ".join(ran.out.split())


def test_few_degrees_of_freedom_are_said_with_the_factor_to_take(run: Run, tmp_path: Path) -> None:
    ran = run("calibrate", write(tmp_path, "few.json", arbitrary_orientations(3, orientations=11, se=None)))
    assert "k = 4.5" in " ".join(ran.out.split())


def test_refusals_are_said_in_russian_and_results_stay_as_they_are(run: Run, good_file: Path, bad_file: Path) -> None:
    refused = run("--lang", "ru", "calibrate", bad_file)
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "stand.alpha_deg: равно 90" in refused.err
    assert run("--lang", "ru", "calibrate", good_file, "--json").out == run("calibrate", good_file, "--json").out
