"""Updates the catalogues from the sources: new messages come in untranslated, removed ones go."""

from collections.abc import Iterable
from io import BytesIO

from babel.messages import Catalog
from babel.messages.pofile import read_po, write_po

from service.languages.catalogue import forms_of, path_of
from service.languages.entry import MessageEntry
from service.languages.language import Language
from service.languages.sources import messages

WIDTH = 120
"""Columns of a line in the file."""


def updated(language: Language, extracted: Iterable[MessageEntry]) -> Catalog:
    """The catalogue of exactly the messages of the sources, with existing translations."""
    with path_of(language).open("rb") as file:
        before = read_po(file, locale=language.value)
    after = Catalog(locale=language.value)
    for message in extracted:
        existing = after.get(message.text)
        places = [*existing.locations, (message.place, 0)] if existing else [(message.place, 0)]
        if existing and not message.many:
            existing.locations = list(dict.fromkeys(places))
            continue
        old = before.get(message.id) or before.get(message.text)
        translation = old.string if old and bool(message.many) == isinstance(old.id, tuple) else ""
        after.delete(message.text)
        after.add(message.id, translation or "", locations=list(dict.fromkeys(places)))
    return after


def written(catalogue: Catalog, head: str) -> str:
    """The catalogue as the text of a file with its header; without line numbers, which change with every edit of a
    source.
    """
    file = BytesIO()
    write_po(file, catalogue, width=WIDTH, include_lineno=False, ignore_obsolete=True, omit_header=True)
    return f"{head}\n\n{file.getvalue().decode()}"


def untranslated(catalogue: Catalog) -> list[str]:
    """English texts without a translation."""
    return [str(message.id) for message in catalogue if message.id and not forms_of(message)]


def update() -> list[str]:
    """Updates every catalogue; returns untranslated messages."""
    missing = list[str]()
    for language in Language:
        if language is not Language.ENGLISH:
            catalogue = updated(language, messages())
            head = path_of(language).read_text("utf-8").split("\n\n")[0].rstrip()
            path_of(language).write_text(written(catalogue, head), "utf-8")
            missing += untranslated(catalogue)
    return missing
