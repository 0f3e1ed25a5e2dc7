"""Lists: a table on a terminal, one JSON object a line in a pipe, or as `--format` says."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any

import typer
from rich.console import RenderableType
from rich.table import Table

from service.commands.console import print_json, screen


class Form(StrEnum):
    """What a list is printed as."""

    TABLE = "table"
    JSON = "json"
    JSONL = "jsonl"


FormOf = Annotated[
    Form | None,
    typer.Option(
        "--format",
        help="table; json: one document; jsonl: one object a line.",
        show_default="table on a terminal, jsonl in a pipe",
    ),
]
AsLines = Annotated[bool, typer.Option("--json", help="The same as --format jsonl.")]


@dataclass(frozen=True)
class Listing:
    """How somebody wants a list."""

    chosen: Form | None
    as_lines: bool = False

    @property
    def form(self) -> Form:
        """What was chosen by hand; else what suits whoever reads."""
        if self.chosen is not None:
            return self.chosen
        return Form.JSONL if self.as_lines or not sys.stdout.isatty() else Form.TABLE

    def show(self, rows: Sequence[Any], view: Callable[[], RenderableType]) -> None:
        """Prints the rows as they were answered, or the view of them."""
        if self.form is Form.TABLE:
            screen().print(view())
        elif self.form is Form.JSON:
            print_json(list(rows))
        else:
            for row in rows:
                print_json(row)


def rows_of(records: Sequence[Any]) -> list[dict[str, Any]]:
    """Records as JSON has them, moments in ISO 8601."""
    return [{name: _plain(value) for name, value in asdict(record).items()} for record in records]


def _plain(value: Any) -> Any:
    return value.isoformat() if isinstance(value, datetime) else value


def table_of(*headings: str, right: Sequence[str] = ()) -> Table:
    """An empty table without lines; numbers stand to the right."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for heading in headings:
        table.add_column(heading, justify="right" if heading in right else "left", overflow="fold")
    return table
