"""The words of the Python sources: templates of `estimator.message`, and string literals that read as words."""

import ast
import re
from collections.abc import Iterator

from estimator.message import PLACE

MessageId = str | tuple[str, ...]
"""A text as in the source; of a counted thing, what is said of one and of several."""
LETTERS = re.compile(r"[A-Za-z]{2}")
"""Pattern that every message contains."""
SILENT_CALLS = frozenset(
    (
        *("Field", "Query", "Path", "Header", "Body", "Option", "Argument", "Tag", "TypeVar", "NewType", "compile"),
        *("getLogger", "info", "warning", "debug", "exception", "AssertionError", "execute", "text", "add_argument"),
        "names_on_demand",
    )
)
"""Calls whose texts are for programs and programmers."""
SPACED = re.compile(
    r"[A-Za-z]{2,}[,:;.]? +[(\"']?[a-z±={\x00A-Z]|\x00[,:;.]? (a )?[a-z]{2,}|^ ?[a-z]{2,} ?[:\x00(]|^[a-z]{4,} \d"
)
"""Pattern of a text with at least two words, or a word beside a value."""
HEADING = re.compile(r"^[A-Z][a-z]+[.:!?]?$|^[A-Z][a-z]+,? [^\sA-Za-z]{1,3}(, \S+)?$")
CODE = re.compile(r"[_<>{}\[\]\\|=&#\n]|://|^[a-z]+/|^--|^var\(|:[QTNO]$|^-//|^[a-z]+-[a-z]+, ")
QUERY = re.compile(r"^SELECT ")
"""Pattern of a query, which is not in words."""
SENTENCE = re.compile(r"(\S+ ){4}.*[.:]$|(\S+ ){8}")
"""Words all the same: ``with the coverage factor k = 2.``"""
TEMPLATES = {"say": 1, "say_count": 2, "translated": 1}
"""Functions of `estimator.message` that take templates, with the number of templates."""
ERRORS = re.compile(r"[A-Z]\w+Error$")
"""Errors of the service take the parts of their sentence."""
OF_A_FIELD = ("add", "add_to_schedule", "fail", "problem_at", "refusal", "_refused")
"""Functions that take a place, then a template, and its parts."""
HELPERS = {
    "counted": ("{n} @", "{n} @s"),
    "few": ("{n} @ is too few", "{n} @s are too few"),
}
"""Messages of the functions of `estimator.wording` for a counted thing."""


def messages(source: str, *, headings: bool, described: bool = False) -> Iterator[MessageId]:
    """The messages of a module, in order; ``headings``: also single capitalised words; ``described``: also descriptions
    of fields."""
    for node in _texts_in(ast.parse(source), described=described):
        if isinstance(node, ast.Call):
            yield _of_call(node)
        elif isinstance(node, ast.Constant) and _is_message(str(node.value), headings=headings):
            yield str(node.value)


def said(source: str) -> Iterator[MessageId]:
    """The messages of a command: the templates of calls, since its help stays English."""
    calls = (node for node in _texts_in(ast.parse(source), described=False) if isinstance(node, ast.Call))
    return (_of_call(call) for call in calls if _name(call.func) in TEMPLATES or ERRORS.match(_name(call.func)))


def finished(source: str) -> Iterator[str]:
    """Sentences that are f-strings: they have lost their parts and cannot be translated."""
    for node in _texts_in(ast.parse(source), described=False):
        if isinstance(node, ast.JoinedStr):
            text = "".join(str(v.value) if isinstance(v, ast.Constant) else "{value}" for v in node.values)
            if _is_message(text, headings=False) and LETTERS.search(PLACE.sub(" ", text)):
                yield text


def _texts_in(node: ast.AST, *, described: bool) -> Iterator[ast.expr]:
    """Texts that are neither documentation nor for programs, and calls with templates."""
    skipped = 0
    if isinstance(node, ast.Constant):
        if isinstance(node.value, str):
            yield node
        return
    if isinstance(node, ast.JoinedStr):
        yield node
        for value in node.values:
            if isinstance(value, ast.FormattedValue):
                yield from _texts_in(value.value, described=described)
        return
    if isinstance(node, ast.Call):
        if _name(node.func) in SILENT_CALLS:
            yield from (k.value for k in node.keywords if described and k.arg == "description")
            return
        if _templates(node):
            yield node
            skipped = len(_templates(node))
    for child in list(_children(node))[skipped and skipped + 1 :]:
        yield from _texts_in(child, described=described)


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """The children of a node without documentation, decorators, annotations, keys, and examples for programs."""
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


def _templates(call: ast.Call) -> list[str]:
    name = _name(call.func)
    count = int(bool(call.keywords)) if ERRORS.match(name) else TEMPLATES.get(name, 0)
    if name in HELPERS:
        arguments = call.args[-1:]
    else:
        arguments = call.args[1:2] if name in OF_A_FIELD and call.keywords else call.args[:count]
    return [a.value for a in arguments if isinstance(a, ast.Constant) and isinstance(a.value, str)]


def _of_call(call: ast.Call) -> MessageId:
    texts = _templates(call)
    if (name := _name(call.func)) in HELPERS:
        texts = [form.replace("@", texts[0]) for form in HELPERS[name]]
    return tuple(texts) if len(texts) > 1 else texts[0]


def _is_message(text: str, *, headings: bool) -> bool:
    """Whether it reads as words."""
    plain = PLACE.sub("\x00", text)
    if QUERY.search(plain) or (CODE.search(plain) and not (SENTENCE.search(plain) and "\n" not in plain)):
        return False
    return bool(SPACED.search(plain)) or (headings and bool(HEADING.search(plain)))
