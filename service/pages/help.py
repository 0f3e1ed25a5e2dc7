"""The pages that explain the service.

A term that is in `docs/glossary.md` too has the same meaning there, to the letter; a test compares the two.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from estimator.message import joined, say
from service.sessions.states import RecordState
from service.sessions.words.conditions import MEANINGS, STATES
from service.settings import PREFIX, VERSION, Origin, Settings
from service.storage.engine import shown_url
from service.web.dependencies import SettingsOf
from service.web.render import render

HIDDEN = "set, not shown"
NONE = "none"
ORIGINS = {Origin.DEFAULT: "default", Origin.ENVIRONMENT: "environment", Origin.START: "option at the start"}
FILES = "_file"
"""End of the names of settings that say where a secret lies: the place is shown, what lies there is not."""


@dataclass(frozen=True)
class SettingRow:
    """One setting."""

    variable: str
    value: str
    origin: str
    is_default: bool
    text: str


@dataclass(frozen=True)
class SettingsPage:
    """Everything the page of settings shows."""

    version: str
    rows: tuple[SettingRow, ...]
    """Settings that somebody set first, then by name."""


def settings_page(settings: Settings) -> SettingsPage:
    """The page of the settings in force."""
    rows = (_row(settings, name) for name in Settings.model_fields)
    return SettingsPage(VERSION, tuple(sorted(rows, key=lambda row: (row.is_default, row.variable))))


def _row(settings: Settings, name: str) -> SettingRow:
    field, origin = Settings.model_fields[name], settings.origin_of(name)
    value = getattr(settings, name)
    is_secret = not field.repr
    return SettingRow(
        variable=f"{PREFIX}{name.upper()}",
        value=(HIDDEN if value else NONE) if is_secret else _value(settings, name, value),
        origin=say("{origins}, from a file", origins=ORIGINS[origin])
        if name.endswith(FILES) and value
        else ORIGINS[origin],
        is_default=origin is Origin.DEFAULT,
        text=field.description or "",
    )


def _value(settings: Settings, name: str, value: Any) -> str:
    if name == "database_url":
        return shown_url(settings.database)
    return _plain(value)


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None or value == "" or value == ():
        return NONE
    if isinstance(value, tuple):
        return joined(", ", ("=".join(item) if isinstance(item, tuple) else str(item) for item in value))
    if isinstance(value, Mapping | Path):
        return str(value)
    return (
        f"{value:,}"
        if isinstance(value, int) and value > 9999
        else f"{value:g}"
        if isinstance(value, float)
        else str(value)
    )


SCHEMAS = "#/components/schemas/"
JSON = "application/json"
WITHOUT = ("401", "403", "422")
"""Answers that nearly every call may give; the head of the page explains them once."""


@dataclass(frozen=True)
class FieldHelp:
    """A parameter of a call, or a field of a body."""

    name: str
    place: str
    """``path``, ``query``, ``header``; empty for a field of a body."""
    kind: str
    schema: str
    """Name of the schema that it is of, which the page leads to; empty of a plain value."""
    needed: bool
    text: str


@dataclass(frozen=True)
class Answer:
    """Possible answer to a call."""

    status: str
    text: str
    kinds: tuple[str, ...]
    """Media types."""
    schema: str


@dataclass(frozen=True)
class CallHelp:
    """One operation."""

    anchor: str
    method: str
    path: str
    summary: str
    role: str
    """The least role that may; empty where nobody needs one."""
    fields: tuple[FieldHelp, ...]
    body: str
    """Name of the schema of the body; empty where it is no JSON."""
    body_kinds: tuple[str, ...]
    answers: tuple[Answer, ...]


@dataclass(frozen=True)
class Section:
    """The calls of one subject."""

    name: str
    calls: tuple[CallHelp, ...]


@dataclass(frozen=True)
class Schema:
    """The fields of one kind of document."""

    name: str
    text: str
    fields: tuple[FieldHelp, ...]


@dataclass(frozen=True)
class ReferencePage:
    """Everything the reference shows."""

    version: str
    sections: tuple[Section, ...]
    schemas: tuple[Schema, ...]


def reference_page(described: Mapping[str, Any]) -> ReferencePage:
    """The page of an OpenAPI document."""
    sections: dict[str, list[CallHelp]] = {}
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            call = _call(method.upper(), path, operation)
            sections.setdefault(next(iter(operation.get("tags", ())), "operation"), []).append(call)
    schemas = described["components"]["schemas"]
    return ReferencePage(
        version=described["info"]["version"],
        sections=tuple(Section(name, tuple(calls)) for name, calls in sorted(sections.items())),
        schemas=tuple(_schema(name, schemas[name]) for name in sorted(schemas)),
    )


def _call(method: str, path: str, operation: Mapping[str, Any]) -> CallHelp:
    text, _, role = operation.get("description", "").partition("Needs the role ")
    sent = operation.get("requestBody", {}).get("content", {})
    return CallHelp(
        anchor=f"{method.lower()}{path}".replace("/", "-").replace("{", "").replace("}", ""),
        method=method,
        path=path,
        summary=text.strip() or operation.get("summary", ""),
        role=role.rstrip("."),
        fields=tuple(map(_parameter, operation.get("parameters", ()))),
        body=_schema_of(sent.get(JSON, {}).get("schema", {})),
        body_kinds=tuple(sent),
        answers=tuple(
            _answer(status, said) for status, said in operation["responses"].items() if status not in WITHOUT
        ),
    )


def _parameter(given: Mapping[str, Any]) -> FieldHelp:
    schema = given.get("schema", {})
    text = given.get("description") or schema.get("description", "")
    return FieldHelp(given["name"], given["in"], _kind(schema), _schema_of(schema), given.get("required", False), text)


def _answer(status: str, said: Mapping[str, Any]) -> Answer:
    content = said.get("content", {})
    first: Mapping[str, Any] = next(iter(content.values()), {})
    return Answer(status, said.get("description", ""), tuple(content), _schema_of(first.get("schema", {})))


def _schema(name: str, schema: Mapping[str, Any]) -> Schema:
    needed = schema.get("required", ())
    fields = tuple(
        FieldHelp(field, "", _kind(described), _schema_of(described), field in needed, described.get("description", ""))
        for field, described in schema.get("properties", {}).items()
    )
    return Schema(name, schema.get("description", ""), fields)


def _kind(schema: Mapping[str, Any]) -> str:
    """``list of integer or null``."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(SCHEMAS)
    for combined in ("anyOf", "oneOf", "allOf"):
        if combined in schema:
            return " or ".join(dict.fromkeys(_kind(option) for option in schema[combined]))
    if "enum" in schema:
        return " | ".join(map(str, schema["enum"]))
    if "const" in schema:
        return str(schema["const"])
    if schema.get("type") == "array":
        return say("list of {schema}", schema=_kind(schema.get("items", {})))
    return str(schema.get("format") or schema.get("type") or "anything")


def _schema_of(schema: Mapping[str, Any]) -> str:
    """The first schema that another one refers to."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(SCHEMAS)
    inner = [*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ()), schema.get("items", {})]
    return next(filter(None, (_schema_of(part) for part in inner if part)), "")


WORDS = (
    ("unit", "one IMU, known by its serial number"),
    ("unit type", "what units share: nominal axes, tolerances, longest calibration interval"),
    ("lot", "units of one production"),
    ("block", "the sensors of a unit that are mounted together and calibrated together"),
    ("session", "one file, one block, one day: the rows, what was set and who measured"),
    ("position", "one still setting of the block: an angle β on the stand, or an orientation"),
    ("stand, head", "the two-axis stand; its part that turns by β"),
    ("input axis", "the direction that a sensor measures; it differs slightly from the nominal one"),
    ("reference", "the session that the others of its epoch are judged against: the first by time measured, or the one "
     "that an engineer chose"),
    ("epoch", "the time between two services"),
    ("deviation", "the change of a parameter since the reference; of a scale factor relative, of an axis an angle"),
    ("tolerance", "the largest deviation allowed"),
    ("margin", "1 − (\\|y\\| + U)/T: 1 is no change, 0 the limit of a pass"),
    ("residual", "measured minus modelled, at the input"),
    ("cause", "one physical effect that the baseline lacks: cubic term, eccentric angle scale, exchanged rows"),
    ("baseline", "the model with K, b, c and e of every sensor and the stand's stated random errors, and nothing else"),
    ("flag", "a matter that needs attention, from raised to resolved"),
    ("drift", "a steady change of a parameter; a *step* is a sudden one"),
    ("risk", "the probability that any parameter of the unit is out of tolerance by a date"),
    ("due", "the date of the next calibration"),
)  # fmt: skip
MEASURES = (
    ("µg, mg", "of accelerometers' bias: a millionth and a thousandth of standard gravity, 9.80665 m/s²"),
    ("ppm, %", "of scale factors: parts in a million, in a hundred"),
    ("arcsec", "of axes: a 3600th of a degree, 4.85 µrad"),
    ("°/h, °/s", "of gyros' bias: degrees per hour, per second"),
    ("µg/g²", "of quadratic terms: µg at one g, growing with the square"),
    ("per g, per °/s", "of scale factors: reading units (V, counts, pulses) for one g, for one degree a second"),
    ("± U", "expanded uncertainty: the true value lies within it in about 95 of 100 cases"),
)
WHEN = (
    ("A unit is to be measured",
     "Ask on the page Ready whether it is warm and still enough; while it is measured, the page Missing says which "
     "positions are still to come."),
    ("A unit is unfit",
     "Do not use it. Adjust or repair it, record the service on its page, and measure it again: the next session is "
     "its new reference."),
    ("A unit is probably unfit, or probably fit",
     "Its worst parameter is closer to the tolerance than the uncertainty of the measurement. Measure it again at "
     "more positions: the page Plan says how many."),
    ("A session is undecided",
     "A parameter was not observed, or not well enough; the first sentence says which. Repeat the session as the "
     "page Plan proposes."),
    ("A verdict has a reservation",
     "A finding about the session qualifies the verdict. Read it, and follow its advice before you rely on the "
     "verdict."),
    ("A session is questioned",
     "Its file cannot be right: a wrong unit, sign, channel or clock. Correct the file, or let an engineer "
     "accept it with a reason. Until then it does not count."),
    ("A file is refused",
     "Nothing was stored. Every problem is listed with its place and what to do: correct the file and send it again."),
    ("The wrong file was uploaded",
     "An engineer withdraws the session on its page. It stays readable but no longer counts."),
    ("A unit is overdue",
     "Measure it, or take it out of use: the risk that it is out of tolerance grows."),
    ("A stand is marked: check before use",
     "All units measured on it changed together, or a diagnosis found it at fault. Check stand and fixture; then an "
     "engineer resolves its flags."),
    ("A stand's certificate has expired",
     "Traceability of sessions since then is interrupted. Have the stand calibrated, or record its new certificate on "
     "its page."),
    ("A flag is open",
     "An engineer acknowledges it with a name and a reason, does what it asks for, and resolves it. The unit's page "
     "shows its history."),
)  # fmt: skip

KEYS = (
    (("/",), "to the field that searches the list"),
    (("j", "k"), "to the next or the previous row, session or flag"),
    (("Enter",), "opens the row"),
    (("x",), "ticks the flag"),
    (("?",), "this page"),
    (("Ctrl",), "with the mouse wheel zooms a chart; then drag it; a double click shows all of it again"),
)


def plainly(meaning: str) -> str:
    """The meaning without the markup of the glossary."""
    return meaning.replace("\\|", "|").replace("*", "")


COUNTS = "It counts."
"""Meaning of an accepted record; the other states state why they do not count."""


@dataclass(frozen=True)
class HelpPage:
    """Contents of the page of help, each a term and its meaning."""

    when: tuple[tuple[str, str], ...]
    states: tuple[tuple[str, str], ...]
    measures: tuple[tuple[str, str], ...]
    words: tuple[tuple[str, str], ...]
    keys: tuple[tuple[tuple[str, ...], str], ...]


def help_page() -> HelpPage:
    """The help page, the same for everybody."""
    states = tuple((STATES[state], MEANINGS[state] or COUNTS) for state in RecordState)
    return HelpPage(WHEN, states, MEASURES, tuple((word, plainly(meaning)) for word, meaning in WORDS), KEYS)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/help")
def show_help(request: Request) -> HTMLResponse:
    """Shows advice for common tasks, and the meaning of the terms."""
    return render(request, "help.html", help_page())


@router.get("/api-reference")
def show_reference(request: Request) -> HTMLResponse:
    """Shows every call of the API."""
    return render(request, "reference.html", reference_page(request.app.openapi()))


@router.get("/settings")
def show_settings(request: Request, settings: SettingsOf) -> HTMLResponse:
    """Shows the settings in force, and their sources."""
    return render(request, "settings.html", settings_page(settings))
