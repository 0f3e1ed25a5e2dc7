"""Answers of the service, as documented in `docs/api.md`; SI, times in UTC. `document` is always the whole answer, with
the fields that are not named here.

These types are independent of the service's own records, so that a client needs nothing else of the service.
"""

from dataclasses import dataclass, fields, is_dataclass
from datetime import datetime
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from estimator.json_object import Json
from service.errors import ServiceError

Verdict = Literal["pass", "conditional-pass", "undecidable", "conditional-fail", "fail"]


@dataclass(frozen=True)
class Reservation:
    """Reason against taking a verdict as it stands."""

    kind: str
    text: str
    advice: str
    document: Json


@dataclass(frozen=True)
class Said:
    """A verdict, and how to say it to people: ``said``, never the verdict alone."""

    verdict: Verdict | None
    is_reference: bool
    reason: str
    said: str
    reservations: tuple[Reservation, ...]
    document: Json


@dataclass(frozen=True)
class Receipt(Said):
    """The answer to an upload."""

    id: str
    unit: str
    created: bool
    """Whether it is new; false where the same content was stored already."""
    state: str
    url: str


@dataclass(frozen=True)
class Session(Said):
    """A stored session."""

    id: str
    unit: str
    programme: str
    stand: str | None
    started_at: datetime
    uploaded_at: datetime
    state: str
    stage: str | None
    revision: int


@dataclass(frozen=True)
class Unit(Said):
    """A unit in short, by its latest session."""

    serial: str
    unit_type: str
    usable: bool
    use: str
    """Whether it may be used, in words, with what to do."""
    sessions: int
    last_session: str | None
    last_at: datetime | None
    worst_sensor: str | None
    worst_parameter: str | None
    margin: float | None
    """1 − (|d| + U)/T of the worst parameter: 0 is the edge of pass."""
    flags: int
    due: datetime | None
    lot: str | None


@dataclass(frozen=True)
class Point:
    """One parameter of one sensor at one session."""

    session: str
    at: datetime
    sensor: str
    kind: str
    parameter: str
    value: float | None
    u: float | None
    """Standard uncertainty of the value."""
    lower: float | None
    """The value less U, upper with U more."""
    upper: float | None
    reference: float | None
    deviation: float | None
    """Change from the reference: relative for scale, else SI."""
    expanded: float | None
    """U of the deviation."""
    tolerance: float | None
    verdict: Verdict
    is_reference: bool
    axis: tuple[float, ...] | None
    revision: int
    document: Json


@dataclass(frozen=True)
class Finding:
    """A named cause."""

    cause: str
    sensors: tuple[str, ...]
    amplitude: tuple[float | None, ...]
    sigma: tuple[float | None, ...]
    """One standard uncertainty of each amplitude."""
    units: tuple[str, ...]
    p_value: float | None
    alternatives: tuple[str, ...]
    sentence: str
    advice: str
    document: Json


@dataclass(frozen=True)
class Diagnosis:
    """Diagnosis of a session."""

    session: str
    unit: str
    state: str
    summary: str
    findings: tuple[Finding, ...]
    """Findings, strongest first."""
    unexplained: bool
    verdict_after: Verdict | None
    """Verdict with the named causes in the model."""
    notes: tuple[str, ...]
    document: Json


@dataclass(frozen=True)
class Flag:
    """A matter that somebody must look after."""

    id: int
    unit: str
    matter: str
    place: str
    state: str
    summary: str
    proposal: str
    session: str | None
    raised_at: datetime
    changed_at: datetime
    document: Json


@dataclass(frozen=True)
class Usable:
    """Whether a unit may be used now."""

    usable: bool
    """Whether the unit may be used; false in doubt."""
    why: str
    reasons: tuple[str, ...]
    reservations: tuple[str, ...]
    until: datetime | None
    session: str | None
    as_of: datetime
    document: Json


T = TypeVar("T")
WHOLE = "document"
"""The field with the whole answer."""


def read(kind: type[T], document: Any) -> T:
    """An answer, or one object within it, as a type; ServiceError where the service is of another version."""
    try:
        return _object(kind, document)
    except (KeyError, TypeError, ValueError) as fault:
        raise ServiceError(f"The service's answer cannot be read as {kind.__name__}: {fault!r}.") from fault


@cache
def _hints(kind: type[Any]) -> dict[str, Any]:
    return get_type_hints(kind)


def _object(kind: type[T], document: Json) -> T:
    hints, names = _hints(kind), [field.name for field in fields(kind)]  # type: ignore[arg-type]  # all are dataclasses
    known = {name: _value(hints[name], document[name], name) for name in names if name != WHOLE}
    return kind(**known, **({WHOLE: document} if WHOLE in names else {}))


def _value(hint: Any, value: Any, name: str) -> Any:
    origin = get_origin(hint)
    if origin in (Union, UnionType):
        return None if value is None else _value(next(a for a in get_args(hint) if a is not NoneType), value, name)
    if origin is tuple:
        return tuple(_value(get_args(hint)[0], item, name) for item in value)
    if origin is Literal:
        return _checked(value, value in get_args(hint), name)
    if is_dataclass(hint):
        return _object(hint, value)  # type: ignore[arg-type]  # a class, not an object of one
    if hint is datetime:
        return datetime.fromisoformat(value)
    if hint is float:
        return float(_checked(value, isinstance(value, int | float), name))
    return _checked(value, isinstance(value, hint), name)


def _checked(value: Any, is_valid: bool, name: str) -> Any:
    if not is_valid:
        raise TypeError(f"{name} is {value!r}")
    return value
