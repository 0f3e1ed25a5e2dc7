"""Pages in a language: templates with their texts exchanged, values and charts said in it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from jinja2 import BaseLoader, Environment, FileSystemLoader
from markupsafe import Markup

from service.languages.catalogue import Catalogue, catalogue_of
from service.languages.language import Language
from service.languages.templates import in_language


class Spoken:
    """What the templates of a language use. English is what everything is written in, and is left alone."""

    def __init__(self, language: Language) -> None:
        self._catalogue = None if language is Language.ENGLISH else catalogue_of(language)

    def templates(self, folder: Path) -> BaseLoader:
        """Where the templates come from."""
        return FileSystemLoader(folder) if self._catalogue is None else _Exchanged(folder, self._catalogue)

    def say(self, value: Any) -> Any:
        """A value of a page as people read it; markup and numbers are not touched."""
        if self._catalogue is None or isinstance(value, Markup) or not isinstance(value, str):
            return value
        return self._catalogue.say(value)

    def plural(self, number: int) -> int:
        """Which plural form a number needs."""
        return 0 if self._catalogue is None else self._catalogue.plural(int(number))

    def chart(self, data: Any) -> Any:
        """A chart's definition with its titles said in the language."""
        return data if self._catalogue is None else self._catalogue.chart(data)


class _Exchanged(FileSystemLoader):
    """Templates with their texts exchanged before they are compiled."""

    def __init__(self, folder: Path, catalogue: Catalogue) -> None:
        super().__init__(folder)
        self._catalogue = catalogue

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        """The source in the language of the catalogue."""
        source, path, is_current = super().get_source(environment, template)
        return in_language(source, self._catalogue.forms), path, is_current
