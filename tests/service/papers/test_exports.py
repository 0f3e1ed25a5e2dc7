"""Exports for other programs: no text of a file is ever worked out by a spreadsheet."""

from dataclasses import replace

from service.judging.records import said
from service.pages.fleet.api import fleet_table
from service.pages.unit.schemas import UnitInUse
from service.web.files import as_csv
from tests.service.pages.records import unit_summary


def exported(serial: str, margin: float) -> str:
    """The line of one unit."""
    unit = UnitInUse(**said(replace(unit_summary(), serial=serial, margin=margin)), usable=True, use="May be used")
    return bytes(as_csv(fleet_table([unit]), "x.csv").body).decode()


def test_text_that_looks_like_a_formula_is_shown_as_text() -> None:
    for serial in ("=1+1", "+1", "-1", "@SUM(A1)"):
        assert f"'{serial}," in exported(serial, 0.5)


def test_numbers_stay_numbers() -> None:
    assert ",-0.25," in exported("BA-017", -0.25).splitlines()[1]


def test_other_text_is_left_alone() -> None:
    assert exported("BA-017", 0.5).splitlines()[1].startswith("BA-017,")
