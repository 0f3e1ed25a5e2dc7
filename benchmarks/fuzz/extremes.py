"""Extreme numbers in every numeric place of a session file: one case is one number in one place of one file."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from io import BytesIO
from typing import Any

import xlsxwriter

from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, raw_log
from tests.service.recordings import recording_document
from tests.service.turntable import alignment_bytes, rate_table_bytes

SIZES = ("1e-320", "5e-324", "1e-300", "1e-60", "1e-30", "1e-6", "1", "1e6", "1e18", "1e30", "1e300", "1.7e308")
"""Subnormal numbers, those whose squares are 0 or infinite, and ordinary ones."""
WHOLE = (str(2**63), str(2**64), str(-(10**30)), str(10**400))
NO_NUMBERS = ("true", "NaN", "Infinity", "-Infinity", '"1"', '"1e-320"', "null", "1e400")
EXTREMES = ("0", "-0.0", *(sign + size for size in SIZES for sign in ("", "-")), *WHOLE, *NO_NUMBERS)
"""Extreme numbers as JSON writes them, and as Python's reader takes them."""
MARK = "@number@"

Document = dict[str, Any]
Way = tuple[str | int, ...]


@dataclass(frozen=True)
class Case:
    """A file, with one number in one place or in a whole column."""

    programme: str
    way: Way
    number: str
    whole: bool
    """Whether every row of the column has it."""

    @property
    def name(self) -> str:
        """Name of the case in the table."""
        place = ".".join(map(str, self.way))
        return f"{self.programme}: {place}{'[]' if self.whole else ''} = {self.number[:20]}"

    def content(self, unit: str) -> bytes:
        """The file as JSON, of a unit, a type and a stand of its own, so that none is evidence about another."""
        return json.dumps(self.document(unit)).replace(f'"{MARK}"', self.number).encode()

    def document(self, unit: str) -> Document:
        """The file with a mark where the number stands."""
        document: Document = json.loads(json.dumps(programmes()[self.programme])) | {"unit": unit, "unit_type": unit}
        if "stand" in document:
            document["stand"]["id"] = unit
        parent: Any = document
        for key in self.way[:-1]:
            parent = parent[key]
        known = parent[self.way[-1]]
        parent[self.way[-1]] = [MARK] * len(known) if self.whole else MARK
        return document


def cases() -> Iterator[Case]:
    """Every extreme in every place of every programme."""
    for programme, document in programmes().items():
        for way, whole in places(document):
            for number in EXTREMES:
                yield Case(programme, way, number, whole)


def places(node: object, way: Way = ()) -> Iterator[tuple[Way, bool]]:
    """The places of numbers: the first of a kind, a row and the whole of every column."""
    if isinstance(node, dict):
        for key, child in node.items():
            yield from places(child, (*way, key))
    elif isinstance(node, list) and way[:1] == ("table",):
        if any(isinstance(cell, int | float) for cell in node):
            yield (*way, 1), False
            yield way, True
    elif isinstance(node, list):
        yield from places(node[0], (*way, 0))
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield way, False


@cache
def programmes() -> dict[str, Document]:
    """A small session of every programme, with every optional number."""
    stand = accelerometer_block(3, positions=4)
    for sensor in stand["sensors"]:
        sensor |= {"nominal_offset": 0.0, "position_m": [0.1, 0.0, 0.0]}
    stand["stand"]["sigma_arcsec"] |= {"wobble": 1.0, "latitude": 1.0, "meridian": 1.0}
    stand["table"]["vibration_m_s2"] = [1e-3] * len(stand["table"]["beta_deg"])
    log = raw_log(3, orientations=6, still=30, moving=10)
    return {
        "two-axis-stand": stand,
        "pulse gyroscopes": gyro_block(3, positions=4),
        "arbitrary-orientations": arbitrary_orientations(3, orientations=12, direction_sigma_deg=1.0),
        "raw log": log,
        "rotation-alignment": json.loads(alignment_bytes()),
        "rate-table": json.loads(rate_table_bytes()),
        "in-service": recording_document(seconds=20),
    }


def in_csv(case: Case, unit: str) -> bytes:
    """The case as CSV; the table holds the number as it is written."""
    head = case.document(unit)
    table = head.pop("table")
    lines = [",".join(table), *(",".join(map(_cell, row)) for row in zip(*table.values(), strict=True))]
    return (
        f"# {json.dumps(head)}\n{chr(10).join(lines)}\n".replace(f'"{MARK}"', case.number)
        .replace(MARK, case.number.strip('"'))
        .encode()
    )


def in_xlsx(case: Case, unit: str) -> bytes:
    """The case as a workbook; a number that no cell can hold is a text there."""
    head = case.document(unit)
    table = head.pop("table")
    value = _value(case.number)
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer, {"nan_inf_to_errors": True}) as book:
        session, readings = book.add_worksheet("session"), book.add_worksheet("readings")
        for j, (key, own) in enumerate(head.items()):
            text = json.dumps(own).replace(f'"{MARK}"', case.number) if isinstance(own, dict | list) else own
            session.write_row(j, 0, [key, value if text == MARK else text])
        for k, (name, column) in enumerate(table.items()):
            readings.write_column(0, k, [name, *(value if cell == MARK else cell for cell in column)])
    return buffer.getvalue()


def _cell(cell: object) -> str:
    return "" if cell is None else str(cell)


def _value(number: str) -> float | str:
    try:
        return float(number)
    except ValueError:
        return number
