"""`imu-health convert`: recordings of public data sets to session files."""

import json
from pathlib import Path
from typing import Annotated

import typer

from estimator.errors import SessionError
from service.commands.console import are_large, progress
from service.commands.exits import UNUSABLE, say
from service.ingest.convert import FORMATS, convert

FORMAT_HELP = "\n\n".join(f"* `{f.name}`: {f.description} Files: {f.files}" for f in FORMATS)
"""The list of formats in the help."""


def convert_files(
    format_name: Annotated[str, typer.Argument(metavar="FORMAT", help="One of " + ", ".join(f.name for f in FORMATS))],
    files: Annotated[list[Path], typer.Argument(metavar="FILE", help="The recording.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder to write the session files to.")] = Path(),
) -> None:
    """Turn a recording of a public data set into session files."""
    if format_name not in {f.name for f in FORMATS}:
        raise typer.BadParameter(f"{format_name!r} is not a known format; see imu-health convert --help")
    try:
        with progress(1, "converting", is_long=are_large(files)):
            sessions = convert(format_name, files)
    except SessionError as fault:
        say(str(fault))
        raise typer.Exit(UNUSABLE) from fault
    out.mkdir(parents=True, exist_ok=True)
    for name, document in sessions:
        target = out / name
        target.write_text(json.dumps(document, allow_nan=False), encoding="utf-8")
        typer.echo(str(target))


convert_files.__doc__ = f"{convert_files.__doc__}\n\n{FORMAT_HELP}"
