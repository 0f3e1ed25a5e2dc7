"""The fleet's condition as a file, by its form."""

from datetime import datetime

from service.languages.language import Language
from service.papers.fleet.paper import fleet_pdf
from service.papers.fleet.report import fleet_report
from service.papers.fleet.workbook import fleet_xlsx
from service.storage.queries import Store


def fleet_file(store: Store, form: str, now: datetime, language: Language) -> bytes:
    """A workbook of everything, or two pages and a section for every unit that is not fit."""
    make = fleet_xlsx if form == "xlsx" else fleet_pdf
    return make(store, fleet_report(store, now), language)
