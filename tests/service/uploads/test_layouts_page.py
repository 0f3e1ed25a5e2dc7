"""The page of a table of one's own layout: understood, corrected, looked at, and stored only as it was shown."""

import re
from datetime import UTC, datetime, timedelta
from html import unescape
from typing import Any

import httpx
import pytest

from service.demo.blocks import sensors_of
from service.kit.arriving_files import held
from service.storage import Storage
from service.storage.aside import FOLDER, MOST, RETENTION, aside, drop_stale, set_aside
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service import tables

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
TABLE = tables.text_table(tables.own_document()).encode("cp1251")
ADDRESS = "/upload/layout"
SAID = {
    "fact.unit": "MY-1", "fact.unit_type": "MY", "fact.day": "2026-03-01", "fact.clock": "09:00", "fact.offset": "Z",
    "fact.stand.id": "S1", "fact.stand.alpha_deg": "40", "fact.site.latitude_deg": "55,81", "arrangement": "cone",
    **{f"sensor.A{k}.{key}": value for k in (1, 2, 3) for key, value in (("scale", "0,12"), ("unit", "V"))},
}  # fmt: skip
"""Entries of the form."""


def shown(page: str) -> dict[str, str]:
    """The fields of a page as a browser sends them."""
    fields = {}
    for tag in re.findall(r"<input [^>]*>", page):
        name, value = (re.search(rf' {key}="([^"]*)"', tag) for key in ("name", "value"))
        if name and 'type="file"' not in tag:
            fields[name[1]] = unescape(value[1]) if value else ""
    for name, options in re.findall(r'<select name="([^"]*)"[^>]*>(.*?)</select>', page, re.DOTALL):
        chosen = re.search(r'<option(?: value="([^"]*)")? selected>([^<]*)', options)
        first = re.search(r'<option(?: value="([^"]*)")?>([^<]*)', options)
        found = chosen or first
        fields[name] = unescape(found[1] if found and found[1] is not None else found[2] if found else "")
    return fields


def sent(client: httpx.Client, fields: dict[str, str], **changes: str) -> httpx.Response:
    whole = {name: (None, value) for name, value in {**fields, **changes}.items()}
    return client.post(ADDRESS, files=whole, headers={"Accept": "text/html"})


def first_page(client: httpx.Client, content: bytes = TABLE) -> str:
    return client.post(ADDRESS, files={"file": ("own.csv", content)}).text


def looked_at(client: httpx.Client, **changes: Any) -> dict[str, str]:
    """The form after everything was said and looked at."""
    page = sent(client, shown(first_page(client)), **{**SAID, **changes, "do": "look"})
    assert page.status_code == 200
    return shown(page.text)


def test_an_upload_of_a_table_leads_to_its_page(client: httpx.Client) -> None:
    answer = client.post("/upload", files={"files": ("own.csv", TABLE)})
    assert answer.status_code == 200
    assert f'action="{ADDRESS}"' in answer.text
    assert client.get("/api/v1/sessions").json()["sessions"] == []


def test_the_page_chooses_what_was_understood(client: httpx.Client) -> None:
    fields = shown(first_page(client))
    assert [fields[f"as.{k}"] for k in range(6)] == ["run", "beta_deg", "temperature_c", "A1", "A2", "A3"]
    assert [fields[f"unit.{k}"] for k in range(1, 6)] == ["deg", "°C", "mV", "mV", "mV"]
    assert [fields[f"word.0.{k}"] for k in range(2)] == ["direct", "flipped"]


def test_what_was_shown_is_stored(client: httpx.Client) -> None:
    answer = sent(client, looked_at(client), do="store")
    assert answer.status_code == 303, answer.text
    session = client.get(answer.headers["location"].replace("/sessions", "/api/v1/sessions")).json()
    assert (session["unit"], session["started_at"][:19]) == ("MY-1", "2026-03-01T09:00:00")


def test_what_was_shown_in_russian_is_stored(client: httpx.Client) -> None:
    client.headers["Accept-Language"] = "ru"
    answer = sent(client, looked_at(client), do="store")
    assert answer.status_code == 303, answer.text


def test_what_was_changed_since_is_shown_first(client: httpx.Client) -> None:
    answer = sent(client, looked_at(client), **{"fact.stand.alpha_deg": "41", "do": "store"})
    assert answer.status_code == 200
    assert "The settings have changed" in answer.text
    assert client.get("/api/v1/sessions").json()["sessions"] == []


def test_what_is_missing_cannot_be_stored(client: httpx.Client) -> None:
    page = sent(client, shown(first_page(client)), do="store").text
    assert "Something is still missing" in page
    assert 'value="store"' not in page


def test_what_title_rows_state_stands_in_the_form(client: httpx.Client) -> None:
    titles = "Serial: BA-17;Date: 2026-05-03 09:30 +05:30\nStand ODG-1;Operator: K. Ito\n\n".encode("cp1251")
    fields = shown(first_page(client, titles + TABLE))
    said = [fields[f"fact.{key}"] for key in ("unit", "day", "clock", "offset", "stand.id", "operator")]
    assert said == ["BA-17", "2026-05-03", "09:30", "+05:30", "ODG-1", "K. Ito"]


def faults(page: str) -> dict[str, str]:
    """Faults by the label of their field."""
    rows = re.findall(r"<tr><td>([^<]*)</td><td[^>]*>[^<]*</td><td>([^<]*)</td></tr>", page)
    return {unescape(label): unescape(said) for label, said in rows}


def refused(client: httpx.Client, **changes: str) -> dict[str, str]:
    """Faults of the form after these changes."""
    page = sent(client, shown(first_page(client)), **{**SAID, **changes, "do": "look"})
    assert (page.status_code, 'value="store"' in page.text) == (200, False)
    return faults(page.text)


def test_what_is_missing_is_called_as_the_form_calls_it(client: httpx.Client) -> None:
    found = faults(first_page(client))
    axes = {f"A{k}: {what}" for k in (1, 2, 3) for what in ("input axis", "scale factor")}
    asked = {"Serial number of the unit", "Measured on", "Stand: name or number", "Elevation of the head's axis α, °"}
    assert found.keys() == axes | asked | {"Measured gravity, m/s²"}
    assert not re.search(r"[a-z]_[a-z]|\[\d", " ".join(found.values()))


@pytest.mark.parametrize(
    ("field", "text", "label", "said"),
    [
        ("fact.stand.alpha_deg", "999", "Elevation of the head's axis α, °", "is 999; must be from -90 to 90 degrees"),
        ("fact.site.latitude_deg", "north", "Latitude, °", "is 'north'; write a number"),
        ("fact.count_time_s", "1", "Pulses: count time, s", "empty this field"),
        ("fact.programme", "rate-table", "rate of the table", "no column is read as this yet"),
        ("fact.offset", "+99:00", "Measured on", "state the day"),
        ("cone_angle", "999", "Half-angle of the cone", "999° is no angle of a cone (0 to 90°)"),
        ("sensor.A1.axis", "30 95", "A1: input axis", "is not three numbers; give x y z in block axes, or azimuth"),
        ("sensor.A2.scale", "much", "A2: scale factor", "is 'much'; write a number"),
        ("as.3", "", "A2: input axis", ""),
        ("as.4", "A1", "column Датчик 2, мВ", "another column is also read as 'A1'; leave one out"),
        ("table.header_row", "x", "Headings in row", "is 'x'; must be a whole number"),
        ("table.first_row", "999", "Table", "has no row of numbers"),
        ("unit.1", "furlong", "β, turn of the head", "choose the unit of column 'Угол, град'"),
        ("word.0.0", "", "run: direct or flipped", ""),
    ],
)  # fmt: skip
def test_a_fault_of_a_field_is_said_under_its_label(
    client: httpx.Client, field: str, text: str, label: str, said: str
) -> None:
    changes = {field: text} if field == "cone_angle" or "axis" not in field else {field: text, "arrangement": ""}
    changes |= {"arrangement": ""} if field == "as.3" else {}
    assert said in refused(client, **changes)[label]


@pytest.mark.parametrize(
    ("written", "axis"),
    [
        ("0 0", "1 0 0"), ("90; 0", "0 1 0"), ("−90°, 0°", "0 -1 0"), ("12 90", "0 0 1"),
        ("0,6 0,8 0", "0.6 0.8 0"), ("0.6, 0.8, 0", "0.6 0.8 0"), ("1,0,0", "1 0 0"),
    ],
)  # fmt: skip
def test_an_axis_is_written_as_components_or_as_two_angles(client: httpx.Client, written: str, axis: str) -> None:
    fields = looked_at(client, arrangement="", **{"sensor.A1.axis": written})
    assert fields["sensor.A1.axis"] == axis


def test_the_cone_is_that_of_the_simulator(client: httpx.Client) -> None:
    block = sensors_of("accelerometer", 6)
    names = [sensor.name for sensor in block]
    said = SAID | {f"sensor.{name}.{key}": value for name in names for key, value in (("scale", "0.12"), ("unit", "V"))}
    table = "run;beta, deg;" + ";".join(f"{name}, V" for name in names)
    rows = [f"{run};{30 * k};" + ";".join(f"{k}{i}" for i in range(6)) for run in ("direct", "flipped") for k in (1, 2)]
    page = first_page(client, "\n".join((table, *rows)).encode())
    fields = shown(sent(client, shown(page), **{**said, "arrangement": "cone-simulated", "do": "look"}).text)
    for sensor in block:
        found = [float(component) for component in fields[f"sensor.{sensor.name}.axis"].split()]
        assert found == pytest.approx(sensor.nominal_axis, abs=1e-9)


def test_a_column_can_be_left_out_and_a_unit_corrected(client: httpx.Client) -> None:
    fields = looked_at(client, **{"as.2": "", "unit.1": "rad"})
    assert (fields["as.2"], fields["unit.1"]) == ("", "rad")


def test_words_of_the_run_can_be_corrected(client: httpx.Client) -> None:
    fields = looked_at(client, **{"word.0.0": "flipped", "word.0.1": "direct"})
    assert [fields[f"word.0.{k}"] for k in range(2)] == ["flipped", "direct"]


def test_how_the_file_is_taken_apart_can_be_chosen(client: httpx.Client) -> None:
    fields = shown(first_page(client))
    page = sent(client, fields, **{"table.encoding": "koi8-r", "do": "look"}).text
    assert shown(page)["table.encoding"] == "koi8-r"
    assert "Угол" not in page


def test_facts_of_a_known_type_are_taken(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", json=tables.own_document())
    name = client.get("/api/v1/unit-types").json()["unit_types"][0]["name"]
    fields = shown(sent(client, shown(first_page(client)), like=name, do="look").text)
    assert (fields["fact.stand.id"], fields["sensor.A2.scale"], fields["fact.unit"]) == ("ODG-1", "0.12", "")


def remarked(count: int) -> bytes:
    """The table with so many columns of long remarks: 2.5 MB each."""
    remarks = f";{'x' * 100_000}" * count
    return "\r\n".join(f"{line}{remarks}" for line in TABLE.decode("cp1251").splitlines()).encode("cp1251")


def test_a_table_of_megabytes_comes_back_with_the_page(client: httpx.Client) -> None:
    fields = shown(first_page(client, remarked(1)))
    assert sent(client, fields, **SAID, do="look").status_code == 200


def test_a_damaged_form_is_said(client: httpx.Client) -> None:
    fields = shown(first_page(client))
    assert sent(client, fields, mapping="[").status_code == 422
    assert sent(client, fields, content="%%%").status_code == 422


def test_headings_are_text_on_the_page(client: httpx.Client) -> None:
    page = first_page(client, b'<script>alert(1)</script>;"A1, mV"\n1;2\n3;4\n')
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert" in page


def test_a_large_table_is_chosen_once(client: httpx.Client, storage: Storage) -> None:
    card = shown(client.post("/upload", files={"files": ("own.csv", remarked(2))}).text)
    own = {"filename": card["filename"], "aside": card["aside"]}
    fields = shown(sent(client, shown(sent(client, own).text), **{**SAID, "do": "look"}).text)
    assert "content" not in card | fields
    assert client.get("/api/v1/sessions").json()["sessions"] == []
    assert sent(client, fields, do="store").status_code == 303
    assert list((storage.files.folder / FOLDER).glob("*")) == []


def test_what_is_set_aside_is_its_owners_alone(client: httpx.Client, storage: Storage) -> None:
    digest = set_aside(storage.files, "a.silva", TABLE, NOW)
    answer = sent(client, {"filename": "own.csv", "aside": digest})
    assert (answer.status_code, "upload it again" in answer.text) == (422, True)
    found = [aside(storage.files, who, digest, NOW) for who in ("a.silva", "k.ito")]
    assert [one and held(one) for one in found] == [TABLE, None]


def test_it_is_kept_for_half_a_day_after_it_was_looked_at(storage: Storage) -> None:
    digest = set_aside(storage.files, "", TABLE, NOW)
    later = NOW + RETENTION - timedelta(minutes=1)
    assert aside(storage.files, "", digest, later) is not None
    drop_stale(storage.files, later + RETENTION - timedelta(minutes=1))
    assert aside(storage.files, "", digest, later + RETENTION) is None
    drop_stale(storage.files, later + RETENTION)
    assert list((storage.files.folder / FOLDER).glob("*")) == []


def test_the_oldest_give_way(storage: Storage, monkeypatch: pytest.MonkeyPatch) -> None:
    def kept(tables: list[tuple[str, bytes]]) -> list[bool]:
        digests = [
            set_aside(storage.files, who, text, NOW + timedelta(seconds=k)) for k, (who, text) in enumerate(tables)
        ]
        return [aside(storage.files, who, one, NOW) is not None for (who, _), one in zip(tables, digests, strict=True)]

    assert kept([("a", b"%d" % k) for k in range(MOST + 1)]) == [False] + [True] * MOST
    monkeypatch.setattr("service.storage.aside.MOST_BYTES", 1000)
    assert kept([(who, who.encode() * 900) for who in "bcd"]) == [False, True, True]


def test_a_text_that_cannot_be_cut_is_cut_by_hand(client: httpx.Client) -> None:
    own = ("Protocol 7~of the stand\n" + "".join(f"{k}~{k % 5}.5~{-k % 7}.25\n" for k in range(1, 30))).encode()
    card = client.post("/upload", files={"files": ("odd.txt", own)})
    assert card.status_code == 200
    page = sent(client, {name: shown(card.text)[name] for name in ("filename", "content")}).text
    assert "Protocol 7~of the stand" in page
    assert faults(page)["Table"].startswith("has no row of numbers")
    cut = shown(sent(client, shown(page), **{"table.sign": "~", "do": "look"}).text)
    assert [name for name in cut if name.startswith("as.")] == ["as.0", "as.1", "as.2"]
    assert (cut["table.separator"], cut["table.first_row"]) == ("~", "2")
    again = shown(sent(client, cut, **{"table.first_row": "4", "do": "look"}).text)
    assert (again["table.separator"], again["table.first_row"]) == ("~", "4")


def test_a_record_that_is_none_is_cleared(client: httpx.Client) -> None:
    rows = [f"{'AB'[k % 2]},{k}" + f",{k % 7}.5" * (2 + k % 2) for k in range(40)]
    fields = shown(first_page(client, "\n".join(rows).encode()))
    assert fields["table.record"] in ("A", "B")
    cleared = shown(sent(client, fields, **{"table.record": "", "do": "look"}).text)
    assert (cleared["table.record"], len([name for name in cleared if name.startswith("as.")])) == ("", 5)
    assert shown(sent(client, cleared, do="look").text)["table.record"] == ""
