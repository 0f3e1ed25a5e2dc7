"""The catalogues made to agree with the sources: what is new comes in without words, what is no longer said goes."""

from collections.abc import Iterable
from io import BytesIO

from babel.messages import Catalog
from babel.messages.pofile import read_po, write_po

from service.languages.catalogue import forms_of, path_of
from service.languages.entry import Entry
from service.languages.language import Language
from service.languages.sources import messages

WIDTH = 120
"""Columns of a line in the file."""


def updated(language: Language, extracted: Iterable[Entry]) -> Catalog:
    """The catalogue of exactly what the sources say, with the translations that were there."""
    with path_of(language).open("rb") as file:
        before = read_po(file, locale=language.value)
    after = Catalog(locale=language.value)
    for message in extracted:
        known = after.get(message.text)
        places = [*known.locations, (message.place, 0)] if known else [(message.place, 0)]
        if known and not message.many:
            known.locations = list(dict.fromkeys(places))
            continue
        old = before.get(message.id) or before.get(message.text)
        said = old.string if old and bool(message.many) == isinstance(old.id, tuple) else ""
        after.delete(message.text)
        after.add(message.id, said or "", locations=list(dict.fromkeys(places)))
    return after


def written(catalogue: Catalog, head: str) -> str:
    """As a file with its head; without numbers of lines, which change with every edit of a source."""
    file = BytesIO()
    write_po(file, catalogue, width=WIDTH, include_lineno=False, ignore_obsolete=True, omit_header=True)
    return f"{head}\n\n{file.getvalue().decode()}"


def untold(catalogue: Catalog) -> list[str]:
    """English texts without a translation."""
    return [str(one.id) for one in catalogue if one.id and not forms_of(one)]


def update() -> list[str]:
    """Writes every catalogue anew; returns what still needs words."""
    missing = list[str]()
    for language in Language:
        if language is not Language.ENGLISH:
            catalogue = updated(language, messages())
            head = path_of(language).read_text("utf-8").split("\n\n")[0].rstrip()
            path_of(language).write_text(written(catalogue, head), "utf-8")
            missing += untold(catalogue)
    return missing
