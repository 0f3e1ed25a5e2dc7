"""Frozen dataclasses as plain JSON, and back, by their type annotations.

What a type does not tell is stated in the head of its class, see `Document`. A number that is not finite is written as
null, which is NaN again where a number must stand; an array is nested lists. What an earlier version did not write gets
the field's default, and what no field names is ignored.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from enum import Enum
from functools import cache
from math import isfinite, nan
from types import NoneType, UnionType
from typing import Any, ClassVar, Literal, Self, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from estimator.json_object import Json
from estimator.message import Message, as_document, with_messages
from estimator.moments import in_utc

T = TypeVar("T")
Reader = Callable[[Any], Any]
AS_THEY_ARE = (str, int, bool, NoneType)


class UnreadableError(ValueError):
    """A document cannot be read; the message names the place."""

    def __init__(self, problem: str, path: str = "") -> None:
        super().__init__(f"{path}: {problem}" if path else problem)
        self.problem, self.path = problem, path

    def within(self, key: str | int) -> "UnreadableError":
        """The error as seen from the object or list that holds the place."""
        rest = f".{self.path}" if self.path and not self.path.startswith("[") else self.path
        return UnreadableError(self.problem, f"[{key}]{rest}" if isinstance(key, int) else f"{key}{rest}")


@dataclass(frozen=True)
class Form:
    """How to write a value when its type is not enough; None is null in every form."""

    write: Callable[[Any], Any]
    read: Reader


def named(*names: str) -> Form:
    """A tuple written as an object, each part under its name."""
    return Form(
        lambda parts: dict(zip(names, parts, strict=True)), lambda document: tuple(document[name] for name in names)
    )


DEGREES = Form(lambda angle: np.degrees(angle).tolist(), lambda listed: np.radians(np.array(listed, dtype=float)))
"""Form of angles: degrees in the document, rad inside."""
RUN = Form(
    lambda flipped: ["flipped" if is_flipped else "direct" for is_flipped in flipped],
    lambda names: np.array([name == "flipped" for name in names]),
)
"""Form of (R,) bool, whether the block is flipped: the name of the run for each row."""
MOMENT = Form(lambda stated: stated, in_utc)
"""Form of a moment in UTC; earlier versions kept it as the file states it."""


@dataclass(frozen=True)
class DocumentLayout:
    """The differences between a document and its class; see `Document`."""

    format: str = ""
    order: tuple[str, ...] = ()
    keys: Mapping[str, str] = field(default_factory=dict)
    forms: Mapping[str, Form] = field(default_factory=dict)
    optional: tuple[str, ...] = ()
    earlier: Callable[[Json], Json] | None = None

    def path(self, name: str) -> tuple[str, ...]:
        """Keys under which an attribute stands, from the outermost in."""
        return tuple(self.keys.get(name, name).split("."))


class Document:
    """A dataclass that is written as JSON, with what its types do not tell in the head of the class.

    format : written as the first key, and checked when it is read.
    order : attributes in the order in which they are written, properties among them; all fields where it is left out.
    keys : names that differ from the attribute's; ``axis.value`` is ``value`` in the object ``axis``.
    forms : by attribute.
    optional : attributes that are left out where they are None or an empty tuple.
    earlier : a document of an earlier version as this one writes it, as far as defaults do not do.
    """

    layout: ClassVar[DocumentLayout] = DocumentLayout()

    def __init_subclass__(cls, **stated: Any) -> None:
        cls.layout = DocumentLayout(**stated)

    def to_dict(self) -> Json:
        """Plain JSON."""
        written: Json = PLAIN.written(self)
        return written

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Self:
        """Reads a document that `to_dict` wrote; ValueError with the place of what cannot be read."""
        return PLAIN.read(cls, document)


def layout_of(cls: type) -> DocumentLayout:
    """The layout of any dataclass."""
    return cls.layout if issubclass(cls, Document) else Document.layout


def json_numbers(array: NDArray[Any]) -> Any:
    """Nested lists of an array (R, m), or of any shape, in its unit, SI or none; what is not finite becomes null."""
    boxed = np.asarray(array, dtype=object)
    boxed[~np.isfinite(np.asarray(array, dtype=float))] = None
    return boxed.tolist()


@cache
def _attributes(cls: type) -> tuple[tuple[str, tuple[str, ...], Form | None, bool], ...]:
    """Name, path, form and whether it is optional, of all that is written."""
    layout = layout_of(cls)
    names = layout.order or tuple(attribute.name for attribute in fields(cls))
    return tuple((name, layout.path(name), layout.forms.get(name), name in layout.optional) for name in names)


class Codec:
    """Writes and reads dataclasses; ``forms`` are those of types that JSON does not have."""

    def __init__(self, forms: Mapping[type, Form]) -> None:
        self._forms = forms
        self._readers: dict[Any, Reader] = {}

    def written(self, value: Any) -> Any:
        """The value as JSON has it; TypeError where nothing is known of its type."""
        kind = type(value)
        if kind in AS_THEY_ARE:
            return value
        if kind in self._forms:
            return self._forms[kind].write(value)
        if kind is float:
            return value if isfinite(value) else None
        if kind is tuple or kind is list:
            return [self.written(item) for item in value]
        if isinstance(value, Mapping):
            return {key: self.written(item) for key, item in value.items()}
        return self._written(value)

    def _written(self, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return json_numbers(value)
        if isinstance(value, Enum):
            return value.value
        if isinstance(value, np.generic):
            return self.written(value.item())
        if isinstance(value, str):
            return value
        if is_dataclass(value):
            return self._object(value)
        raise TypeError(f"{type(value).__name__} is not kept as JSON")

    def _object(self, value: Any) -> Json:
        kind: Any = type(value)
        stated = layout_of(kind).format
        document: Json = {"format": stated} if stated else {}
        for name, (*outer, last), form, is_optional in _attributes(kind):
            part = getattr(value, name)
            if is_optional and (part is None or (isinstance(part, tuple) and not part)):
                continue
            holder = document
            for key in outer:
                holder = holder.setdefault(key, {})
            holder[last] = self.written(part if form is None or part is None else form.write(part))
        return document

    def read(self, cls: type[T], document: Any) -> T:
        """The object that was written; ValueError with the place of what cannot be read."""
        value: T = self._reader(cls)(document)
        return value

    def _reader(self, hint: Any) -> Reader:
        if hint not in self._readers:
            self._readers[hint] = self._reader_for(hint)
        return self._readers[hint]

    def _reader_for(self, hint: Any) -> Reader:
        if hint in SIMPLE:
            return SIMPLE[hint]
        if hint in self._forms:
            return _formed(self._forms[hint])
        origin, inner = get_origin(hint), get_args(hint)
        if origin in (Union, UnionType):
            return self._union_reader(inner)
        if origin is tuple:
            return self._tuple(inner)
        if origin is np.ndarray:
            return _array(get_args(inner[1])[0])
        if isinstance(origin, type) and issubclass(origin, Mapping):
            return _mapping(self._reader(inner[1]))
        if origin is Literal:
            return SIMPLE[str]
        if isinstance(hint, type) and issubclass(hint, Enum):
            return _formed(Form(str, hint))
        if isinstance(hint, type) and is_dataclass(hint):
            return self._dataclass(hint)
        raise TypeError(f"{hint} is not kept as JSON")

    def _union_reader(self, inner: tuple[Any, ...]) -> Reader:
        (kind,) = (member for member in inner if member is not NoneType)
        read = self._reader(kind)
        return lambda value: None if value is None else read(value)

    def _tuple(self, inner: tuple[Any, ...]) -> Reader:
        if inner[1:] == (...,):
            read = self._reader(inner[0])
            return lambda value: tuple(_each(value, (read,) * len(_listed(value))))
        parts = tuple(map(self._reader, inner))
        return lambda value: tuple(_each(value, parts))

    def _dataclass(self, cls: type) -> Reader:
        layout = layout_of(cls)
        plan: list[_Place] = []

        def read(document: Any) -> Any:
            plan[:] = plan or self._places(cls)  # late, for a class may hold itself
            if not isinstance(document, Mapping):
                raise UnreadableError(f"an object is expected, not {document!r:.80}")
            if document.get("format", layout.format) != layout.format and layout.format:
                raise UnreadableError(f"it is {document['format']!r}, not {layout.format}", "format")
            current = document if layout.earlier is None else layout.earlier(dict(document))
            return cls(**{place.name: value for place in plan if (value := place.value_in(current)) is not MISSING})

        return read

    def _places(self, cls: type) -> "list[_Place]":
        layout, hints = layout_of(cls), get_type_hints(cls)
        return [
            _Place(
                attribute.name,
                layout.path(attribute.name),
                _optional(layout.forms[attribute.name])
                if attribute.name in layout.forms
                else self._reader(hints[attribute.name]),
                attribute.default is not MISSING or attribute.default_factory is not MISSING,
            )
            for attribute in fields(cls)
            if attribute.init
        ]


@dataclass(frozen=True)
class _Place:
    """The place of a field in a document, with its reader."""

    name: str
    path: tuple[str, ...]
    read: Reader
    has_default: bool

    def value_in(self, document: Any) -> Any:
        """The field's value; MISSING where the document lacks it and it has a default."""
        for key in self.path:
            if not isinstance(document, Mapping) or key not in document:
                if self.has_default:
                    return MISSING
                raise UnreadableError("it is missing", ".".join(self.path))
            document = document[key]
        try:
            return self.read(document)
        except UnreadableError as problem:
            raise problem.within(".".join(self.path)) from None


def _optional(form: Form) -> Reader:
    read = _formed(form)
    return lambda value: None if value is None else read(value)


def _formed(form: Form) -> Reader:
    def read(value: Any) -> Any:
        try:
            return form.read(value)
        except (ValueError, TypeError, KeyError) as problem:
            raise UnreadableError(f"{value!r:.80} cannot be read ({problem})") from None

    return read


def _array(kind: Any) -> Reader:
    number = float if kind is Any else kind
    return _formed(Form(json_numbers, lambda listed: np.array(listed, dtype=number)))


def _number(value: Any) -> Any:
    if value is None:
        return nan
    return _whole(value)


def _whole(value: Any) -> Any:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    raise UnreadableError(f"a number is expected, not {value!r:.80}")


def _of(kind: type, words: str) -> Reader:
    def read(value: Any) -> Any:
        if isinstance(value, kind):
            return value
        raise UnreadableError(f"{words} is expected, not {value!r:.80}")

    return read


def _listed(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return value
    raise UnreadableError(f"a list is expected, not {value!r:.80}")


def _each(value: Any, parts: tuple[Reader, ...]) -> Iterable[Any]:
    if len(_listed(value)) != len(parts):
        raise UnreadableError(f"{len(parts)} entries are expected, not {len(value)}")
    for place, (item, read) in enumerate(zip(value, parts, strict=True)):
        try:
            yield read(item)
        except UnreadableError as problem:
            raise problem.within(place) from None


def _mapping(read: Reader) -> Reader:
    whole = _of(Mapping, "an object")

    def entries(value: Any) -> Json:
        mapping = {}
        for key, item in whole(value).items():
            try:
                mapping[key] = read(item)
            except UnreadableError as problem:
                raise problem.within(key) from None
        return mapping

    return entries


def _text(value: Any) -> Any:
    """A text, or a message with its parts."""
    text = with_messages(value)
    if isinstance(text, str):
        return text
    raise UnreadableError(f"a text is expected, not {value!r:.80}")


SIMPLE: dict[Any, Reader] = {
    float: _number,
    int: _whole,
    str: _text,
    bool: _of(bool, "true or false"),
    Any: with_messages,
}
PLAIN = Codec({})
"""Codec of the estimator: no types beside those that every document has."""
WITH_PARTS: Mapping[type, Form] = {Message: Form(as_document, with_messages)}
"""Messages with their parts, where they are to be said in any language later."""
KEPT = Codec(WITH_PARTS)
"""Codec that keeps messages with their parts."""
