"""What a command says and how it ends: its exit code, a line that says why, and the language of both.

Helps, headings and what a command says of itself stay English. JSON never depends on the language.
"""

import os
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import typer

from estimator.errors import Problem
from estimator.on_demand import function_on_demand
from service.languages.language import Language, of_environment

FAILED = 1
"""Exit code where what was asked for could not be done."""
UNUSABLE = 2
"""Exit code where a file cannot be used."""


def many(number: int, thing: str) -> str:
    """``1 row``, ``12,000 rows``."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def say(line: str) -> None:
    """One line on standard error."""
    typer.echo(" ".join(line.split()), err=True)


if TYPE_CHECKING:
    from service.languages.catalogue import catalogue_of
else:
    catalogue_of = function_on_demand("service.languages.catalogue", "catalogue_of")

CHOSEN = "LANGUAGE"
"""The variable in which gettext programs look first; `--lang` sets it for what the command says."""


def choose(language: Language) -> None:
    """What this command says from now on is said in a language."""
    os.environ[CHOSEN] = language.value


def spoken() -> str:
    """The language of what this command says, as HTTP has it."""
    return of_environment(os.environ).value


def said(text: str) -> str:
    """A sentence that was made in English, in the language of whoever reads it."""
    language = of_environment(os.environ)
    return text if language is Language.ENGLISH else catalogue_of(language).say(text)


def problems_said(problems: Iterable[Problem]) -> str:
    """Problems with their places on one line; fields are named as files name them."""
    return "; ".join(str(replace(problem, message=said(problem.message))) for problem in problems)
