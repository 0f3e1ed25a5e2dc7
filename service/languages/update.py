"""Updates the catalogues from the sources: new messages come in untranslated, removed ones go."""

from babel.messages import Catalog
from babel.messages.pofile import read_po, write_po

from service.languages.catalogue import forms_of, path_of
from service.languages.language import Language
from service.languages.sources import messages

WIDTH = 120
"""Columns of a line in the file."""


def extracted() -> Catalog:
    """The messages of the sources, without translations."""
    catalogue = Catalog()
    for text, place in messages():
        catalogue.add(text, "", locations=[(place, 0)])
    return catalogue


def updated(language: Language, template: Catalog) -> Catalog:
    """The catalogue of exactly the messages of the sources, with existing translations."""
    with path_of(language).open("rb") as file:
        catalogue = read_po(file, locale=language.value)
    catalogue.update(template, no_fuzzy_matching=True, update_creation_date=False)
    return catalogue


def untranslated(catalogue: Catalog) -> list[str]:
    """English texts without a translation."""
    return [str(message.id) for message in catalogue if message.id and not forms_of(message)]


def update() -> list[str]:
    """Updates every catalogue; returns untranslated messages."""
    missing, template = list[str](), extracted()
    for language in Language:
        if language is not Language.ENGLISH:
            catalogue = updated(language, template)
            with path_of(language).open("wb") as file:  # line numbers would change with every edit of a source
                write_po(file, catalogue, width=WIDTH, include_lineno=False, ignore_obsolete=True)
            missing += untranslated(catalogue)
    return missing
