"""The command line, `imu-health`. Exit codes: 0 done, 2 unusable input, 1 anything else.

A command is imported when it is asked for, so that `calibrate` waits for neither a web server nor a database. The list
of commands is plain text: what draws boxes takes longer to import than all else that the list needs.
"""

import sys
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.exceptions import TyperException

from service.commands.catalogue import CATALOGUE
from service.commands.examples import help_of
from service.commands.speech import FAILED, problems_in_words, say, set_language, translated
from service.errors import RefusedError, ServiceError
from service.languages.language import Language


class OnDemand(Mapping[str, Any]):
    """The commands by name, each imported when it is looked up; an unknown name costs no import."""

    def __getitem__(self, name: str) -> Any:
        return _command(name)

    def __iter__(self) -> Iterator[str]:
        return iter(CATALOGUE)

    def __len__(self) -> int:
        return len(CATALOGUE)


class Commands(TyperGroup):
    """The commands as the catalogue has them: they are listed without being imported."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands: Any = OnDemand()

    def list_commands(self, ctx: Any) -> list[str]:
        """All names, in the order of the help."""
        return list(CATALOGUE)

    def shell_complete(self, ctx: Any, incomplete: str) -> Any:
        """Completions of the start of a name, from a group of commands that only have a name and a line."""
        shown = [TyperCommand(name, help=entry.says) for name, entry in CATALOGUE.items()]
        listed = TyperGroup(name=self.name, commands=shown, params=self.params)
        return listed.shell_complete(typer.Context(listed), incomplete)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Every name with what its command does; a mark of code is for where it can be shown."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.says.replace("`", "")) for name, entry in CATALOGUE.items()])


@cache
def _command(name: str) -> Any:
    module, _, member = CATALOGUE[name].home.partition(".")
    found = getattr(import_module(f"service.commands.{module}"), member)
    if not isinstance(found, typer.Typer):
        single = typer.Typer(add_completion=False)
        single.command(name)(found)
        found = single
    return _taught(typer.main.get_command(found), name)


def _taught(command: Any, words: str) -> Any:
    """A command whose help ends with its examples, and those below it."""
    command.rich_markup_mode, command.epilog = "markdown", help_of(words)
    for name, below in getattr(command, "commands", {}).items():
        _taught(below, f"{words} {name}")
    return command


app = typer.Typer(
    name="imu-health", cls=Commands, no_args_is_help=True, pretty_exceptions_enable=False, rich_markup_mode=None
)


@app.callback()
def imu_health(
    lang: Annotated[
        Language | None, typer.Option(help="Of verdicts, findings and refusals.", show_default="the system's: LANG")
    ] = None,
) -> None:
    """In-service health of redundant inertial measurement units."""
    if lang is not None:
        set_language(lang)


def main() -> None:
    """Runs a command; what a user can mend is one line on standard error, never a traceback."""
    try:
        code = app(standalone_mode=False)
    except TyperException as fault:
        typer.echo(fault.format_message(), err=True)
        sys.exit(FAILED)
    except (ServiceError, OSError) as fault:
        cause = getattr(fault.__cause__, "orig", None)
        places = f" {problems_in_words(fault.problems)}" if isinstance(fault, RefusedError) else ""
        say(f"imu-health: {translated(str(fault))}" + (f" ({cause})" if cause else "") + places)
        sys.exit(FAILED)
    sys.exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    main()
