"""Options shared by several commands, and the settings made from them."""

from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from pydantic import BaseModel, ValidationError

from service.settings import Settings

Model = TypeVar("Model", bound=BaseModel)
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
    return checked(Settings, **options)


def checked(model: type[Model], /, **options: Any) -> Model:
    """The model made from the given options; a usage error that names each invalid one."""
    try:
        return model(**{name: value for name, value in options.items() if value is not None})
    except ValidationError as fault:
        faults = "; ".join(f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in fault.errors())
        raise typer.BadParameter(faults) from fault
