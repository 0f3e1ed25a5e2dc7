"""Messages and exit codes of commands, and their language. Help stays English; JSON never depends on the language."""

import os
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import typer

from estimator.errors import Problem
from estimator.message import say as message
from estimator.on_demand import function_on_demand
from service.languages.language import Language, of_environment

FAILED = 1
"""Exit code where the request failed."""
UNUSABLE = 2
"""Exit code for an unusable file."""


def many(number: int, thing: str) -> str:
    """``1 row``, ``12,000 rows``."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


if TYPE_CHECKING:
    from service.languages.catalogue import catalogue_of
else:
    catalogue_of = function_on_demand("service.languages.catalogue", "catalogue_of")

LANGUAGE_VARIABLE = "LANGUAGE"
"""Variable that gettext programs read first; set by `--lang` for the output of the command."""


def set_language(language: Language) -> None:
    """Sets the language of this command's output."""
    os.environ[LANGUAGE_VARIABLE] = language.value


def output_language() -> str:
    """The language of this command's output, for HTTP."""
    return of_environment(os.environ).value


def translated(template: str, /, **parts: object) -> str:
    """An English sentence with its parts in the language of the user."""
    language, text = of_environment(os.environ), message(template, **parts) if parts else template
    return text if language is Language.ENGLISH else catalogue_of(language).say(text)


def say(line: str) -> None:
    """One line on standard error."""
    typer.echo(" ".join(translated(line).split()), err=True)


def problems_in_words(problems: Iterable[Problem]) -> str:
    """Problems with their places on one line; fields have the names in files."""
    return "; ".join(str(replace(problem, message=translated(problem.message))) for problem in problems)
