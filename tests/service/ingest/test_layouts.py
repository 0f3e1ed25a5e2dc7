"""Tables of people's own layout: whatever wrote them, the same content is the same session."""

import zipfile
from contextlib import suppress
from io import BytesIO

import pytest
import xlsxwriter

from estimator.errors import FormatError
from estimator.reading import read_session
from service.ingest import is_own_layout, jobs, look_at, read_upload
from service.ingest.digest import content_digest
from service.ingest.layout import times
from service.ingest.layout.envelope import is_wrapped, unwrapped, wrapped
from service.ingest.layout.understand import SeenColumn, understood
from service.ingest.layout.vocabulary import conversion, plain_label
from tests.service import tables

TEXTS = {
    "utf-8": tables.text_table(tables.own_document()).encode(),
    "utf-8 with a mark": tables.text_table(tables.own_document()).encode("utf-8-sig"),
    "utf-16 with a mark": tables.text_table(tables.own_document()).encode("utf-16"),
    "utf-16 without": tables.text_table(tables.own_document()).encode("utf-16-le"),
    "cp1251": tables.text_table(tables.own_document()).encode("cp1251"),
    "tabs": tables.text_table(tables.own_document(), separator="\t").encode(),
    "commas and points": tables.text_table(tables.own_document(), separator=",", decimal=".").encode(),
    "commas and decimal commas": tables.text_table(tables.own_document(), tables.ENGLISH).encode(),
    "xlsx": tables.xlsx_table(tables.own_document()),
    "xlsx in English": tables.xlsx_table(tables.own_document(), tables.ENGLISH),
    "parquet": tables.parquet_table(tables.own_document()),
    "hdf5": tables.hdf5_table(tables.own_document()),
    "mat": tables.mat_table(tables.own_document()),
}


def mapping_for(content, **changes):
    """The mapping as it is proposed, with the facts."""
    document = tables.own_document()
    seen = look_at(content, "own")
    columns = understood([SeenColumn(**column) for column in seen["columns"]], document["sensors"])
    facts = tables.facts_of(document)
    return {"format": "imu-mapping/1", "table": dict(seen["taken"]), "columns": columns, "session": facts} | changes


def workbook(*rows, merged=()):
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        sheet = book.add_worksheet("data")
        for j, row in enumerate(rows):
            sheet.write_row(j, 0, row)
        for area, text in merged:
            sheet.merge_range(area, text)
    return buffer.getvalue()


@pytest.mark.parametrize("kind", TEXTS)
def test_the_same_content_is_the_same_session_whatever_wrote_it(kind):
    content = TEXTS[kind]
    session = read_upload(wrapped(mapping_for(content), content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


@pytest.mark.parametrize("kind", TEXTS)
def test_a_table_says_that_it_is_of_its_own_layout(kind):
    assert is_own_layout(TEXTS[kind], "own")


@pytest.mark.parametrize("content", [b"", b"{}", b"[1]", b'# {"format": 1}\na,b\n', b"PK\x03\x04 none", b"\x00\x01"])
def test_other_files_are_no_table(content):
    assert not is_own_layout(content, "x")


@pytest.mark.parametrize(
    ("heading", "meaning", "unit"),
    [
        ("RUN", "run", ""), ("Ход", "run", ""), ("β, град", "beta_deg", "deg"), ("beta_deg", "beta_deg", "deg"),
        ("Angle of the head [arcmin]", "beta_deg", "arcmin"), ("Время, мин", "time_s", "min"),
        ("t (ms)", "time_s", "ms"),
        ("T, °C", "temperature_c", "°C"), ("Temp [K]", "temperature_c", "K"), ("A2 [µV]", "A2", "µV"),
        ("а2, мкВ", "A2", "µV"), ("Channel 2", "A2", ""), ("readings ch 02 (V)", "A2", "V"), ("a2_se", "A2_se", ""),
        ("СКО А2, мВ", "A2_se", "mV"), ("№ п/п", None, ""), ("whatever", None, ""),
    ],
)  # fmt: skip
def test_headings_are_understood(heading, meaning, unit):
    sensors = [{"name": name} for name in ("A1", "A2", "A3")]
    (column,) = understood([SeenColumn(heading, ("1",), numeric=True, empty=False)], sensors)
    assert (column["as"], column.get("unit", "")) == (meaning, unit)


@pytest.mark.parametrize(
    ("unit", "wanted", "number", "turned"),
    [
        ("мВ", "V", 1500.0, 1.5), ("V", "mV", 1.5, 1500.0), ("K", "°C", 300.0, 26.85), ("°F", "°C", 212.0, 100.0),
        ("min", "s", 2.0, 120.0), ("rad", "deg", 3.141592653589793, 180.0), ("g", "m/s²", 1.0, 9.80665),
    ],
)  # fmt: skip
def test_units_are_turned_into_one_another(unit, wanted, number, turned):
    times, over, offset = conversion(unit, wanted)
    assert number * times / over + offset == pytest.approx(turned, rel=1e-12)


def test_units_of_other_quantities_are_not():
    assert conversion("mV", "count") is None
    assert plain_label("мВ") == "mV"


def test_a_unit_that_cannot_be_turned_is_named_with_its_column():
    content = tables.text_table(tables.own_document()).encode()
    mapping = mapping_for(content)
    mapping["columns"][3]["unit"] = "count"
    with pytest.raises(FormatError, match="cannot be converted to V") as caught:
        read_upload(wrapped(mapping, content), "own")
    assert caught.value.problems[0].field == "A1"


@pytest.mark.parametrize("kind", ["text", "xlsx"])
def test_a_fault_names_its_place_in_the_table(kind):
    rows = [list(tables.HEADINGS), *tables.rows_of(tables.own_document())]
    rows[3][3] = "infinite"
    text = "\n".join(";".join(map(str, row)) for row in rows).encode()
    content = text if kind == "text" else workbook(*rows)
    with pytest.raises(FormatError) as caught:
        read_upload(wrapped(mapping_for(content), content), "own")
    (problem,) = caught.value.problems
    assert (problem.field, problem.row) == ("A1", 3)
    assert ("line 4 of the file" if kind == "text" else "cell D4 of the sheet data") in problem.message


def test_two_rows_of_headings_merged_cells_and_a_title_are_understood():
    rows = tables.rows_of(tables.own_document())
    body = [["" if k == 0 and j % 12 else cell for k, cell in enumerate(row)] for j, row in enumerate(rows)]
    body = [[None if cell == "" else cell for cell in row] for row in body]
    content = workbook(
        ["Protocol of the block"], [], ["Stand", None, None, "Readings, mV"],
        ["Run", "Beta, deg", "Temp, °C", "A1", "A2", "A3"], *body,
    )  # fmt: skip
    assert [c["heading"] for c in look_at(content, "x")["columns"]][3:] == [f"Readings A{k} [mV]" for k in (1, 2, 3)]
    session = read_upload(wrapped(mapping_for(content), content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


def test_columns_with_the_same_heading_are_not_confused():
    rows = tables.rows_of(tables.own_document())
    content = workbook([*tables.HEADINGS, None, "Датчик 1, мВ"], *([*row, None, 7] for row in rows))
    mapping = mapping_for(content)
    assert [column["as"] for column in mapping["columns"]][3:] == ["A1", "A2", "A3", None, None]
    session = read_upload(wrapped(mapping, content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


def test_a_workbook_of_200_columns_is_looked_at_and_one_of_400_refused():
    assert len(look_at(workbook([f"c{k}" for k in range(200)], range(200), range(200)), "x")["columns"]) == 200
    with pytest.raises(FormatError, match="400 columns"):
        look_at(workbook([f"c{k}" for k in range(400)], range(400), range(400)), "x")


def test_formulas_are_read_by_their_results():
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        sheet = book.add_worksheet()
        sheet.write_row(0, 0, ["beta, deg", "A1", "=HYPERLINK"])
        sheet.write_row(1, 0, [30, None, "=1+1"])
        sheet.write_formula(1, 1, "=1+1", None, 2)
    seen = look_at(buffer.getvalue(), "x")
    assert [column["cells"] for column in seen["columns"]][:2] == [("30",), ("2",)]


@pytest.mark.parametrize("content", [b"just words", b"1\n2\n3\n", b"a;b\nc;d\n", workbook(["a", "b"]), workbook()])
def test_a_file_without_rows_of_numbers_is_no_table(content):
    with pytest.raises(FormatError):
        look_at(content, "x")


def test_the_bytes_are_kept_unchanged_beside_their_mapping():
    mapping = {"format": "imu-mapping/1", "columns": []}
    archive = wrapped(mapping, b"\xd0;1\r\n")
    assert is_wrapped(archive)
    assert unwrapped(archive, "x") == (mapping, b"\xd0;1\r\n")
    assert wrapped(mapping, b"\xd0;1\r\n") == archive != wrapped({**mapping, "table": {}}, b"\xd0;1\r\n")


def archive_of(*parts, compression=zipfile.ZIP_STORED):
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in parts:
            archive.writestr(name, content)
    return buffer.getvalue()


GOOD = b'{"format": "imu-mapping/1"}'


@pytest.mark.parametrize(
    "content",
    [
        archive_of(("imu-mapping.json", GOOD)),
        archive_of(("imu-mapping.json", GOOD), ("a", b"1"), ("b", b"2")),
        archive_of(("imu-mapping.json", GOOD), ("table.csv", b"0" * 10**6), compression=zipfile.ZIP_DEFLATED),
        archive_of(("imu-mapping.json", b"[" * 10**5), ("table.csv", b"a;b\n1;2\n")),
        archive_of(("imu-mapping.json", b'{"format": "imu-mapping/1", "columns": 7}'), ("table.csv", b"a;b\n1;2\n")),
        archive_of(
            ("imu-mapping.json", b'{"format": "imu-mapping/1", "table": {"separator": ""}}'), ("t", b"a;b\n1;2\n")
        ),
        archive_of(
            ("imu-mapping.json", b'{"format": "imu-mapping/1", "table": {"encoding": "zip"}}'), ("t", b"a;b\n1;2\n")
        ),
        archive_of(
            ("imu-mapping.json", b'{"format": "imu-mapping/1", "session": {"table": {}}}'), ("t", b"a;b\n1;2\n")
        ),
        archive_of(("imu-mapping.json", GOOD), ("table.xlsx", archive_of(("imu-mapping.json", GOOD), ("t", b"1")))),
        wrapped({"format": "imu-mapping/1"}, b"a;b\n1;2\n")[:-40],
    ],
)
def test_an_archive_that_is_none_of_ours_is_refused(content):
    with pytest.raises(FormatError):
        read_upload(content, "x")


def test_times_of_day_count_from_the_first_row_and_over_midnight():
    body = "".join(f"{clock};{cell}\n" for clock, cell in (("23:59:50", 1), ("23:59:59", 2), ("00:00:10", 3)))
    content = f"Время;A1\n{body}".encode()
    mapping = mapping_for(content)
    assert mapping["columns"][0]["as"] == "time_s"
    mapping["session"]["sensors"] = [{"name": "A1"}]
    with pytest.raises(FormatError) as caught:
        read_upload(wrapped(mapping, content), "own")
    assert not [problem for problem in caught.value.problems if problem.field == "time_s"]


@pytest.mark.parametrize(
    ("mapping", "field"),
    [
        ({"format": "imu-mapping/2"}, "format"),
        ({"format": "imu-mapping/1", "columns": [{"as": "A1"}, {"as": "A1"}]}, "columns[2].as"),
        ({"format": "imu-mapping/1", "columns": [{"is": "A1"}]}, "columns[1].is"),
        ({"format": "imu-mapping/1", "columns": [{"as": 5}]}, "columns[1].as"),
        ({"format": "imu-mapping/1", "table": {"first_row": True}}, "table.first_row"),
        ({"format": "imu-mapping/1", "table": {"sheets": "a"}}, "table.sheets"),
        ({"format": "imu-mapping/1", "rows": 5}, "rows"),
    ],
)
def test_a_fault_of_a_mapping_is_named(mapping, field):
    with pytest.raises(FormatError) as caught:
        read_upload(wrapped(mapping, b"a;b\n1;2\n"), "x")
    assert field in [problem.field for problem in caught.value.problems]


def test_a_damaged_envelope_is_refused_whatever_was_changed() -> None:
    content = wrapped({"format": "imu-mapping/1"}, b"x;y\n1;2\n")
    for place in range(len(content)):
        for byte in (0, 128, 255):
            with suppress(FormatError):
                unwrapped(content[:place] + bytes([byte]) + content[place + 1 :], "x.zip")


def titled(*lines, headings=tables.ENGLISH):
    """The table as text below these lines."""
    return ("\n".join(lines) + "\n\n" + tables.text_table(tables.own_document(), headings)).encode()


@pytest.mark.parametrize(
    ("lines", "unit", "started_at", "stand"),
    [
        (["Serial: BA-17", "Date: 2026-05-03", "Stand: ODG-1"], "BA-17", "2026-05-03T12:00:00Z", "ODG-1"),
        (
            ["Serien-Nr.:;0017", "Datum;03.05.2026", "Uhrzeit: 09:30", "Prüfstand;3"],
            "0017", "2026-05-03T09:30:00Z", "3",
        ),
        (["Зав. № БА-17", "Дата измерения: 03.05.2026 9:30", "Стенд ОДГ-1"], "БА-17", "2026-05-03T09:30:00Z", "ОДГ-1"),
        (["S/N 17;Start: 2026-05-03 09:30 +05:30", "Stand;A"], "17", "2026-05-03T09:30:00+05:30", "A"),
        (["Unit: 17", "Date: 2026-05-03", "Time: 09:30-11:00", "Stand: A"], "17", "2026-05-03T09:30:00Z", "A"),
        (["Unit: 17", "Start: 2026-05-03T09:30:00-03:30", "Stand: A"], "17", "2026-05-03T09:30:00-03:30", "A"),
    ],
)  # fmt: skip
def test_title_rows_state_serial_number_date_and_stand(lines, unit, started_at, stand):
    titles = look_at(titled(*lines), "own")["titles"]
    assert titles == {"unit": unit, "started_at": started_at, "stand": {"id": stand}}


@pytest.mark.parametrize(
    "line",
    [
        "Unit of readings: mV",
        "Standard conditions",
        "Time zone: UTC+3",
        "Date: 05/03/2026",
        "Date: 99.99.2026",
        "Units",
    ],
)
def test_a_title_that_states_none_of_them_is_left_alone(line):
    assert look_at(titled(line), "own")["titles"] == {}


def test_a_date_cell_of_a_workbook_is_a_date():
    rows = tables.rows_of(tables.own_document())
    content = workbook(["Serial number", None, "BA-17"], ["Date", 46145], [], list(tables.ENGLISH), *rows)
    assert look_at(content, "own")["titles"] == {"unit": "BA-17", "started_at": "2026-05-03T12:00:00Z"}


GERMAN = ("Lage", "Drehwinkel [°]", "Temperatur (°C)", "Kanal 1 [mV]", "Kanal 2 [mV]", "Beschleunigungsmesser 3 [mV]")


def test_german_headings_and_words_are_understood():
    text = tables.text_table(tables.own_document(), GERMAN).replace("прямой", "direkt").replace("обратный", "umgekehrt")
    content = text.encode("cp1252")
    session = read_upload(wrapped(mapping_for(content), content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


@pytest.mark.parametrize("above", [("Lauf", "Stellung", None), (None, None, None)])
def test_merged_groups_above_numbered_headings_are_no_row_of_readings(above):
    lower = (None if above[0] else "Lauf", "β [°]", "Temperatur [°C]", 1, 2, 3)
    content = workbook(
        [*above, "Beschleunigungsmesser [mV]", None, None], lower, *tables.rows_of(tables.own_document()),
        merged=[("D1:F1", "Beschleunigungsmesser [mV]")],
    )  # fmt: skip
    session = read_upload(wrapped(mapping_for(content), content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


def test_headings_that_come_again_before_the_second_run_are_no_readings():
    rows = tables.rows_of(tables.own_document())
    half = len(rows) // 2
    head = list(tables.ENGLISH)
    content = workbook(["Unit", "BA-17"], head, *rows[:half], [], ["Second run"], head, *rows[half:])
    session = read_upload(wrapped(mapping_for(content), content), "own")
    assert content_digest(session) == content_digest(read_session(tables.own_document()))


def test_another_table_below_is_said():
    rows = tables.rows_of(tables.own_document())
    content = workbook(list(tables.ENGLISH), *rows, [], ["when", "mean", "spread", "count", "x", "y"], [1] * 6, [2] * 6)
    with pytest.raises(FormatError, match=f"another table from row {len(rows) + 3} on"):
        look_at(content, "own")


def test_a_hidden_sheet_is_not_the_one_that_is_read():
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        visible, hidden = book.add_worksheet("shown"), book.add_worksheet("calculated")
        for j, row in enumerate([list(tables.ENGLISH), *tables.rows_of(tables.own_document())]):
            visible.write_row(j, 0, row)
        for j in range(200):
            hidden.write_row(j, 0, [j] * 20)
        hidden.hide()
    assert look_at(buffer.getvalue(), "own")["taken"]["sheet"] == "shown"


def test_only_columns_that_begin_with_times_are_read_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []
    monkeypatch.setattr(times, "moment_of", lambda text: read.append(text))
    rows = "".join(f"{k},{k / 7:.3f},,imu_link,2026-03-01T09:00:{k % 60:02}\n" for k in range(500))
    jobs.look_at(b"n,ax,empty,frame,time\n" + rows.encode(), "log.csv")
    assert {text[:4] for text in read} == {"imu_", "2026"}
    assert len(read) < 50
