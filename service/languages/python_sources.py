"""The words of the Python sources, found without a mark: string literals that read as words, f-strings with places.

An f-string's places bear the names of what stands in them. A conditional ending, ``{'' if n == 1 else 's'}``, makes
a plural of the message, and so does a verb that the same number decides; other conditional words make a message each.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice, product

from service.languages.message import COUNT, PLACE, Message

SILENT_CALLS = frozenset(
    (
        *("Field", "Query", "Path", "Header", "Body", "Option", "Argument", "Tag", "TypeVar", "NewType", "compile"),
        *("getLogger", "info", "warning", "debug", "exception", "AssertionError", "execute", "text", "add_argument"),
    )
)
"""Calls whose texts are for programs and programmers."""
SPACED = re.compile(
    r"[A-Za-z]{2,}[,:;.]? +[(\"']?[a-z±={\x00A-Z]|\x00[,:;.]? (a )?[a-z]{2,}|^ ?[a-z]{2,} ?[:\x00(]|^[a-z]{4,} \d"
)
"""At least two words, or a word beside a value."""
HEADING = re.compile(r"^[A-Z][a-z]+[.:!?]?$|^[A-Z][a-z]+,? [^\sA-Za-z]{1,3}(, \S+)?$")
CODE = re.compile(r"[_<>{}\[\]\\|=&#\n]|://|^[a-z]+/|^--|^var\(|:[QTNO]$|^-//|^[a-z]+-[a-z]+, ")
QUERY = re.compile(r"^SELECT ")
"""What words do not have."""
SENTENCE = re.compile(r"(\S+ ){4}.*[.:]$|(\S+ ){8}")
"""What may have it all the same: ``with the coverage factor k = 2.``"""
ENDINGS = ("s", "es")
MOST = 8
"""Messages that one f-string is written out into."""
HELPERS = {
    "counted": ("{n} @", "{n} @s"),
    "few": ("{n} @ is too few", "{n} @s are too few"),
}
"""What the functions of `estimator.wording` make of a counted thing."""


def messages(source: str, name: str, *, headings: bool, described: bool = False) -> Iterator[Message]:
    """The messages of a module, in order; ``headings``: single words that begin with a capital letter too;
    ``described``: what fields are described by."""
    tree = ast.parse(source)
    for node in _told(tree, described=described):
        for one in _of(node):
            if _is_said(one.text, headings=headings):
                yield replace(one, place=name)


def _told(node: ast.AST, *, described: bool) -> Iterator[ast.expr]:
    """The outermost texts that are neither documentation nor for programs."""
    if isinstance(node, ast.Constant):
        if isinstance(node.value, str):
            yield node
        return
    if isinstance(node, ast.JoinedStr):
        yield node
        for value in node.values:
            if isinstance(value, ast.FormattedValue):
                yield from _told(value.value, described=described)
        return
    if isinstance(node, ast.Call):
        if _name(node.func) in SILENT_CALLS:
            yield from (k.value for k in node.keywords if described and k.arg == "description")
            return
        if _name(node.func) in HELPERS and isinstance(node.args[-1], ast.Constant):
            yield node
    for child in _children(node):
        yield from _told(child, described=described)


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """Without documentation, decorators, annotations, names of keys, and examples for programs."""
    for name, value in ast.iter_fields(node):
        if isinstance(node, ast.keyword) and node.arg == "json_schema_extra":
            continue
        if name in ("annotation", "returns", "decorator_list", "slice", "type_comment"):
            continue
        for child in value if isinstance(value, list) else [value]:
            is_text = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
            if isinstance(child, ast.AST) and not is_text:
                yield child


def _name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _of(node: ast.expr) -> Iterator[Message]:
    if isinstance(node, ast.Call):
        last = node.args[-1]
        assert isinstance(last, ast.Constant)
        one, many = (form.replace("@", str(last.value)) for form in HELPERS[_name(node.func)])
        yield Message(one, many)
    elif isinstance(node, ast.Constant):
        yield Message(_plain(str(node.value)))
    elif isinstance(node, ast.JoinedStr):
        yield from _of_f(node)


def _is_said(text: str, *, headings: bool) -> bool:
    """Whether it reads as words."""
    bare = PLACE.sub("\x00", text)
    if QUERY.search(bare) or (CODE.search(bare) and not (SENTENCE.search(bare) and "\n" not in bare)):
        return False
    return bool(SPACED.search(bare)) or (headings and bool(HEADING.search(bare)))


def _plain(text: str) -> str:
    """A text for ``format``: its places without conversions."""
    return re.sub(r"\{(\w+)[^{}]*\}", r"{\1}", text)


def _of_f(node: ast.JoinedStr) -> Iterator[Message]:
    """The message of an f-string; one for every choice of its conditional words."""
    names = _Names()
    plural = next((v for v in node.values if _ending(v)), None)
    if plural is not None and isinstance(plural, ast.FormattedValue):
        names.count(node, plural)
        agreeing = [v for v in node.values if _choice(v) and _test(v) == _test(plural)]
        of_one = _choice(plural).index("")
        one, many = (_filled(node, names, dict.fromkeys(agreeing, side)) for side in (of_one, 1 - of_one))
        yield Message(one, many)
        return
    choices = [v for v in node.values if _choice(v)]
    for chosen in islice(product((0, 1), repeat=len(choices)), MOST):
        yield Message(_filled(node, names, dict(zip(choices, chosen, strict=True))))


def _filled(node: ast.JoinedStr, names: "_Names", chosen: dict[ast.expr, int]) -> str:
    text = ""
    for value in node.values:
        if isinstance(value, ast.Constant):
            text += str(value.value)
        elif isinstance(value, ast.FormattedValue) and value in chosen:
            text += _choice(value)[chosen[value]]
        elif isinstance(value, ast.FormattedValue) and not text.endswith("}"):
            text += f"{{{names.of(value.value)}}}"
    return text


def _choice(value: ast.expr) -> list[str]:
    """Both words of ``{'a' if x else 'b'}``."""
    if isinstance(value, ast.FormattedValue) and isinstance(value.value, ast.IfExp):
        both = (value.value.body, value.value.orelse)
        words = [b.value for b in both if isinstance(b, ast.Constant) and isinstance(b.value, str)]
        return words if len(words) == len(both) else []
    return []


def _test(value: ast.expr) -> str:
    """What decides between the words."""
    if isinstance(value, ast.FormattedValue) and isinstance(value.value, ast.IfExp):
        return ast.unparse(value.value.test)
    return ""


def _ending(value: ast.expr) -> list[str]:
    both = _choice(value)
    return both if "" in both and any(word in ENDINGS for word in both) else []


class _Names:
    """Names of places, one for each expression."""

    def __init__(self) -> None:
        self._taken: dict[str, str] = {}
        self._counted = ""

    def of(self, node: ast.expr) -> str:
        """The last name in the expression that is no function."""
        source = ast.unparse(node)
        if source == self._counted:
            return COUNT
        called = {_name(n.func) for n in ast.walk(node) if isinstance(n, ast.Call)}
        found = [_name(n) for n in ast.walk(node) if isinstance(n, ast.Attribute | ast.Name)]
        name = next((n for n in found if n and n not in called), next(iter(found), "value"))
        name = name.strip("_").lower()
        name = name if name != COUNT else "some"
        free, k = name, 1
        while self._taken.get(free, source) != source:
            k += 1
            free = f"{name}{k}"
        self._taken[free] = source
        return free

    def count(self, node: ast.JoinedStr, ending: ast.FormattedValue) -> None:
        """Calls the number that the ending depends on ``n``."""
        assert isinstance(ending.value, ast.IfExp)
        test = ending.value.test
        wanted = ast.unparse(test.left) if isinstance(test, ast.Compare) else ""
        before = [v.value for v in node.values[: node.values.index(ending)] if isinstance(v, ast.FormattedValue)]
        exact = [v for v in before if ast.unparse(v) == wanted]
        for value in (exact or before[-1:])[:1]:
            self._counted = ast.unparse(value)
