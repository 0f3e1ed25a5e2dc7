"""Options shared by several commands, and the settings made from them."""

from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import ValidationError

from service.settings import Settings

DatabaseUrl = Annotated[
    str | None,
    typer.Option(help="sqlite:///path or postgresql://user:password@host/name.", show_default="SQLite, data folder"),
]
DataFolder = Annotated[
    Path | None,
    typer.Option(help="Folder of uploaded files and the SQLite database.", show_default="the platform's data folder"),
]


def settings_from(**options: Any) -> Settings:
    """The environment's settings, overridden by the given options."""
    try:
        return Settings(**{name: value for name, value in options.items() if value is not None})
    except ValidationError as fault:
        faults = "; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in fault.errors())
        raise typer.BadParameter(faults) from fault
