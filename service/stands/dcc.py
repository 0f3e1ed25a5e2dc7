"""Step: the Digital Calibration Certificate of a stand (PTB's DCC 2 and 3, D-SI 1 and 2) → the certificate as stored.

The schema has no place for the last day of validity, and no names for the errors of a stand: the day is read from a
statement whose name or `refType` speaks of validity or recalibration, an error from a quantity that is named, or
referred to as ``stand_…``, like the key of the session file's ``stand.sigma_arcsec``.
"""

import re
from calendar import monthrange
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date, timedelta
from math import inf, isfinite, pi

from lxml import etree

from estimator.errors import Problem, problem_at
from estimator.message import say
from estimator.reading.bounds import WITHIN
from estimator.reading.keys import SIGMA
from estimator.reading.setting import ARCSEC
from service.errors import RefusedError
from service.kit.answer import answer
from service.kit.printable import Element
from service.stands.records import StandCertificate, StandError

ROOT = "{https://ptb.de/dcc}digitalCalibrationCertificate"
CORE = "{*}administrativeData/{*}coreData/{*}"
LABORATORY = "{*}administrativeData/{*}calibrationLaboratory/{*}contact/{*}name/{*}content"
NOT_OF_STAND = {"latitude"}
"""An error of the site, which no calibration of a stand measures."""
SPEAKS_OF_VALIDITY = re.compile(r"valid|expir|recalib|next.?calib|rekalib|gültig|действ|очередн", re.IGNORECASE)
PERIOD = re.compile(r"P(?:(\d{1,3})Y)?(?:(\d{1,4})M)?(?:(\d{1,6})D)?")
RADIANS = {
    r"\radian": 1.0, r"\milli\radian": 1e-3, r"\micro\radian": 1e-6, r"\nano\radian": 1e-9,
    r"\degree": pi / 180, r"\arcminute": 60 * ARCSEC, r"\arcsecond": ARCSEC, r"\second\angle": ARCSEC,
}  # fmt: skip
"""One of a D-SI unit of angle."""
EXPANDED = (".//{*}valueExpandedMU", ".//{*}expandedUnc/{*}uncertainty")
STANDARD = (".//{*}valueStandardMU", ".//{*}standardUnc")
MOST_NAMED = 200
"""Characters of a number or a laboratory that are kept."""


@answer
@dataclass(frozen=True)
class ReadCertificate:
    """A certificate of a stand as its document states it."""

    certificate: StandCertificate
    """The certificate as it is stored."""
    errors: tuple[StandError, ...]
    """Errors of the stand whose uncertainty the document states."""


def read_dcc(content: bytes, stand: str, valid_until: date | None) -> ReadCertificate:
    """The certificate of a stand; ``valid_until`` counts where the document does not say it. RefusedError with every
    problem."""
    root = _parsed(content)
    problems: list[Problem] = []
    number, laboratory = (_text(root, path, problems) for path in (CORE + "uniqueIdentifier", LABORATORY))
    issued = _day(root.findtext(CORE + "issueDate") or root.findtext(CORE + "endPerformanceDate"))
    until = (None if issued is None else _stated_end(root, issued)) or valid_until
    if issued is None:
        problems.append(Problem("issueDate", "is missing or is not a date; ask the laboratory for a valid certificate"))
    if until is None:
        problems.append(Problem("valid_until", "is not stated in the certificate; give the last day on which it holds"))
    errors = tuple(_errors(root, problems))
    if problems or issued is None or until is None:
        raise RefusedError("The certificate cannot be used.", tuple(problems))
    return ReadCertificate(StandCertificate(stand, number, laboratory, issued, until), errors)


def _parsed(content: bytes) -> Element:
    """The document: no entity is expanded, nothing is fetched, and none with a document type is taken."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root: Element = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as fault:
        raise RefusedError(say("The file is no XML: {fault}", fault=fault), ()) from fault
    if root.tag != ROOT or root.getroottree().docinfo.doctype:
        raise RefusedError("The file is no Digital Calibration Certificate of PTB's schema.", ())
    return root


def _text(root: Element, path: str, problems: list[Problem]) -> str:
    text = " ".join((root.findtext(path, "") or "").split())
    if not text or len(text) > MOST_NAMED:
        field = path.removesuffix("/{*}contact/{*}name/{*}content").rpartition("}")[2]
        problems.append(problem_at(field, "must be a text of 1 to {most} characters", most=MOST_NAMED))
    return text


def _day(text: str | None) -> date | None:
    try:
        return date.fromisoformat((text or "").strip()[:10])
    except ValueError:
        return None


def _stated_end(root: Element, issued: date) -> date | None:
    """The last day of validity, by a statement with a day or a period; the earliest of several."""
    ends = []
    for statement in root.iterfind(".//{*}statement"):
        names = [name.text or "" for name in statement.iterfind("{*}name/{*}content")]
        if SPEAKS_OF_VALIDITY.search(" ".join([*names, statement.get("refType", "")])):
            day = _day(statement.findtext("{*}date"))
            ends.append(day or _after(issued, statement.findtext("{*}period", "")))
    return min((end for end in ends if end is not None), default=None)


def _after(issued: date, period: str) -> date | None:
    """The last day of a period of whole years, months and days."""
    found = PERIOD.fullmatch(period.strip())
    if found is None or not any(found.groups()):
        return None
    years, months, days = (int(part or 0) for part in found.groups())
    year, month = divmod(12 * (issued.year + years) + issued.month - 1 + months, 12)
    try:
        last = monthrange(year, month + 1)[1]
        return date(year, month + 1, min(issued.day, last)) + timedelta(days=days)
    except (ValueError, OverflowError):
        return None


def _errors(root: Element, problems: list[Problem]) -> Iterator[StandError]:
    """Every error of the stand that the document gives an uncertainty of; of several, the largest."""
    found: dict[str, float] = {}
    for quantity in root.iterfind(".//{*}quantity"):
        for key in set(_keys(quantity)) & set(SIGMA) - NOT_OF_STAND:
            found[key] = max(_sigma(quantity), found.get(key, 0.0))
    for key in (key for key in SIGMA if key in found):
        if found[key] / ARCSEC <= WITHIN["stand.sigma_arcsec"].high:
            yield StandError(key, found[key])
        else:
            units = ", ".join(RADIANS)
            says = say("has no uncertainty with its coverage factor in one of {units}", units=units)
            problems.append(Problem(key, says))


def _keys(quantity: Element) -> Iterator[str]:
    """The possible keys of a quantity: from its references and, for an angle, its names."""
    yield from (t.removeprefix("stand_") for t in quantity.get("refType", "").split() if t.startswith("stand_"))
    if _unit(quantity) in RADIANS:
        names = (name.text or "" for name in quantity.iterfind("{*}name/{*}content"))
        yield from (name.strip().lower().replace(" ", "_") for name in names)


def _unit(quantity: Element) -> str:
    return (quantity.findtext(".//{*}unit") or "").strip()


def _sigma(quantity: Element) -> float:
    """Standard uncertainty, rad; infinite where there is none that can be read."""
    factor, value = _number(quantity, (".//{*}coverageFactor",)), _number(quantity, EXPANDED)
    if value is None:
        factor, value = 1.0, _number(quantity, STANDARD)
    unit = RADIANS.get(_unit(quantity))
    if unit is None or value is None or factor is None or not (value > 0 and factor >= 1):
        return inf
    return value * unit / factor


def _number(quantity: Element, paths: tuple[str, ...]) -> float | None:
    """The first number found, if it is finite."""
    text = next((found for path in paths if (found := quantity.findtext(path))), "nan")
    try:
        return value if isfinite(value := float(text)) else None
    except ValueError:
        return None
