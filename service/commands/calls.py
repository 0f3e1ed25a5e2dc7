"""Commands that make one call of the API: a row of a table becomes a command of Typer.

Names in braces in the address are taken from the command's parameters; the other parameters are the query or the body.
"""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from string import Formatter
from typing import Any
from urllib.parse import quote

import typer
from rich.table import Table

from estimator.json_object import Json
from service.client import Client, connect
from service.commands.catalogue import CATALOGUE
from service.commands.console import (
    DEFAULT_SERVER,
    AsJson,
    AsLines,
    FormOf,
    ListOutput,
    Server,
    plain,
    print_json,
    table_of,
)
from service.commands.speech import FAILED, output_language, translated
from service.languages.language import Language

Answer = Json


@dataclass(frozen=True)
class ListColumns:
    """Printed form of a list; numbers in the first column are aligned to the right."""

    entries: str
    """Field of the answer with the list."""
    empty: str
    cells: Mapping[str, Callable[[Answer], str]]
    """CellKind under each heading, as Rich markup."""
    is_paged: bool = False
    is_numbered: bool = True
    """Whether the first column holds numbers, or names that stand as such."""

    def table(self, rows: list[Answer]) -> Table | str:
        """The rows as a table."""
        if not rows:
            return translated(self.empty)
        table = table_of(*self.cells, right=tuple(self.cells)[: self.is_numbered])
        for row in rows:
            table.add_row(*(cell(row) for cell in self.cells.values()))
        return table


@dataclass(frozen=True)
class Call:
    """A command that makes one call of the API and prints the answer."""

    request: str
    """Method and address below /api/v1."""
    parameters: Mapping[str, Any]
    """Annotation of each, or annotation and default, in the order of the help."""
    show: Callable[[Answer], None] | ListColumns
    """Prints the answer, to which the parameters are added where it has no field of their name."""
    help: str = ""
    """One line; empty where it is in the catalogue."""
    has_json: bool = False
    """Whether ``--json`` prints the answer as it is; lists always have it."""
    shown_instead: str = ""
    """Address of an answer shown in place of the first, with names of its fields."""
    is_failure: Callable[[Answer], bool] = lambda _: False
    """Whether an answer ends the command with exit code 1."""

    def run(self, arguments: dict[str, Any]) -> None:
        """Makes the call and prints the answer."""
        sent = {name: arguments[name] for name in self.parameters}
        with connect(arguments["server"], language=self._language(arguments)) as client:
            if isinstance(self.show, ListColumns):
                rows = self._rows(client, sent, self.show)
                view = self.show.table
                listing = ListOutput(arguments["form"], arguments["as_json"])
                listing.show(rows, lambda: view([arguments | row for row in rows]))
                return
            answer = self._answer(client, sent)
        if arguments.get("as_json"):
            print_json(answer)
        else:
            self.show(arguments | answer)
        if self.is_failure(answer):
            raise typer.Exit(FAILED)

    def _language(self, arguments: dict[str, Any]) -> str:
        """Of the answer: JSON never depends on it."""
        if isinstance(self.show, ListColumns):
            return ListOutput(arguments["form"], arguments["as_json"]).language
        return Language.ENGLISH.value if arguments.get("as_json") else output_language()

    def _rows(self, client: Client, sent: dict[str, Any], columns: ListColumns) -> list[Answer]:
        method, path, rest = _request(self.request, sent)
        if columns.is_paged:
            return list(client.every(path, columns.entries, limit=1000, **rest))
        entries: list[Answer] = client.answer(method, path, params=rest).json()[columns.entries]
        return entries

    def _answer(self, client: Client, sent: dict[str, Any]) -> Answer:
        method, path, rest = _request(self.request, sent)
        body = {"params": rest} if method == "GET" else {"json": rest}
        answer: Answer = client.answer(method, path, **body).json()
        return client.get(in_address(self.shown_instead, answer)).json() if self.shown_instead else answer

    def function(self, name: str, *, is_group: bool) -> Callable[..., None]:
        """The function of a Typer command; for a group it is a no-op where a subcommand was named."""
        parameters = {**({"context": typer.Context} if is_group else {}), **self.parameters, **self._common()}

        def command(**given: Any) -> None:
            context = given.pop("context", None)
            if context is None or context.invoked_subcommand is None:
                self.run(given)

        signature = inspect.Signature([_parameter(key, parameter) for key, parameter in parameters.items()])
        command.__signature__ = signature  # type: ignore[attr-defined]  # which Typer reads
        command.__annotations__ = {key: parameter.annotation for key, parameter in signature.parameters.items()}
        command.__doc__ = self.help or CATALOGUE[name].says
        return command

    def _common(self) -> dict[str, Any]:
        options: dict[str, Any] = {"server": (Server, DEFAULT_SERVER)}
        if isinstance(self.show, ListColumns):
            options |= {"form": (FormOf, None), "as_json": (AsLines, False)}
        elif self.has_json:
            options |= {"as_json": (AsJson, False)}
        return options


Row = Call | Callable[..., None]
"""A command of a table: one call, or a function for several."""


def app_of(name: str, rows: Mapping[str, Row]) -> typer.Typer:
    """The command of a name with its subcommands; a group that is a row itself can be run."""
    subcommands = {words.split()[1]: row for words, row in rows.items() if words.startswith(f"{name} ")}
    row_of_group = rows.get(name)
    app = typer.Typer(
        name=name,
        add_completion=False,
        help=CATALOGUE[name].says,
        no_args_is_help=row_of_group is None,
        invoke_without_command=row_of_group is not None,
    )
    if row_of_group is not None:
        function = (
            row_of_group.function(name, is_group=bool(subcommands)) if isinstance(row_of_group, Call) else row_of_group
        )
        (app.callback() if subcommands else app.command(name))(function)
    for word, row in subcommands.items():
        app.command(word)(row.function(word, is_group=False) if isinstance(row, Call) else row)
    return app


def in_address(template: str, names: Mapping[str, Any]) -> str:
    """An address with its placeholders filled."""
    return template.format(**{name: quote(str(value), safe="") for name, value in names.items()})


def _request(request: str, sent: Json) -> tuple[str, str, Json]:
    method, template = request.split()
    in_path = {name for _, name, _, _ in Formatter().parse(template) if name}
    rest = {name: plain(value) for name, value in sent.items() if name not in in_path and value is not None}
    return method, in_address(template, {name: sent[name] for name in in_path}), rest


def _parameter(name: str, declaration: Any) -> inspect.Parameter:
    annotation, default = declaration if isinstance(declaration, tuple) else (declaration, inspect.Parameter.empty)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=annotation, default=default)
