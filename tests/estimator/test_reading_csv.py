"""CSV with metadata: the same session as JSON, and its faults with the line of the file."""

import json
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from estimator.errors import FormatError
from estimator.reading import read_session
from tests import builders


def table_text(table, separator=",", end="\n"):
    cells = [["" if cell is None else str(cell) for cell in row] for row in zip(*table.values(), strict=True)]
    return "".join(separator.join(row) + end for row in [list(table), *cells])


def metadata_text(document):
    text = json.dumps({key: value for key, value in document.items() if key != "table"}, indent=1)
    return "".join(f"# {line}\n" for line in text.splitlines())


def csv_of(document, **how):
    return (metadata_text(document) + table_text(document["table"], **how)).encode()


def same(one, other):
    """Whether two sessions hold the same, NaN equal to NaN."""
    if is_dataclass(one):
        return type(one) is type(other) and all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other


def problems_of(content):
    with pytest.raises(FormatError) as caught:
        read_session(content)
    return caught.value.problems


@pytest.mark.parametrize("build", builders.EVERY)
def test_csv_and_json_give_the_same_session(build):
    document = build()
    assert same(read_session(csv_of(document)), read_session(json.dumps(document).encode()))


@pytest.mark.parametrize("how", [{"separator": ";"}, {"separator": "\t"}, {"end": "\r\n"}, {"end": "\r"}])
def test_other_separators_and_line_ends(how):
    document = builders.accelerometer_block()
    assert same(read_session(csv_of(document, **how)), read_session(document))


def test_empty_cells_where_they_are_allowed():
    document = builders.arbitrary_orientations(direction_sigma_deg=1.0)
    document["table"]["position"] = ["p1", None, *["p2"] * 22]
    for column in ("direction_x", "direction_y", "direction_z", "A2_se"):
        document["table"][column][-1] = None
    assert same(read_session(csv_of(document)), read_session(document))


def test_a_sidecar_holds_the_metadata(tmp_path):
    document = builders.accelerometer_block()
    table = document.pop("table")
    (tmp_path / "x.json").write_text(json.dumps(document))
    (tmp_path / "x.csv").write_text(table_text(table))
    assert same(read_session(tmp_path / "x.csv"), read_session(document | {"table": table}))


def test_a_table_without_metadata_is_told_what_to_do(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text(table_text(builders.accelerometer_block()["table"]))
    (problem,) = problems_of(path)
    assert "each line starting with #" in problem.message


def test_rows_are_counted_from_the_header_and_lines_from_the_top():
    document = builders.accelerometer_block()
    document["table"]["A2"][4] = "overload"
    lines = csv_of(document).decode().splitlines()
    (problem,) = problems_of(csv_of(document))
    assert (problem.field, problem.row) == ("A2", 5)
    line = next(number for number, text in enumerate(lines, start=1) if "overload" in text)
    assert f"(line {line} of the file)" in problem.message


@pytest.mark.parametrize("cell", ["nan", "inf", "1_000", "0,7", "1e999", ""])
def test_cells_that_are_no_numbers(cell):
    document = builders.accelerometer_block()
    document["table"]["A2"][0] = cell
    assert {(p.field, p.row) for p in problems_of(csv_of(document, separator=";"))} == {("A2", 1)}


def test_a_row_of_another_width_is_named():
    lines = csv_of(builders.accelerometer_block()).decode().splitlines()
    lines[-1] += ",1.0"
    (problem,) = problems_of("\n".join(lines).encode())
    assert (problem.row, "17 cells where the header has 16" in problem.message) == (24, True)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("A2,", "A1,", "two columns"),
        ("A2,", ",", "has no name"),
        ("A2,", '"A2,', "quote is not closed"),
        ("# {", "# {{", "not valid JSON at line 1"),
        ("# {", '# {"table": {},', "is in the metadata"),
    ],
)
def test_faults_of_the_file_itself(old, new, words):
    content = csv_of(builders.accelerometer_block()).decode().replace(old, new, 1).encode()
    assert any(words in p.message for p in problems_of(content))


def test_metadata_without_rows():
    content = metadata_text(builders.accelerometer_block()).encode()
    assert [p.message for p in problems_of(content)] == ["has no rows; give one row per reading"]


def test_too_many_columns():
    content = metadata_text(builders.accelerometer_block()) + ",".join(f"c{k}" for k in range(10_001)) + "\n1"
    assert any("at most 10000" in p.message for p in problems_of(content.encode()))
