"""`imu-health missing`: what a session that is being measured still lacks."""

from pathlib import Path
from typing import Annotated

import typer

from estimator.errors import SessionError
from estimator.planning import missing
from service.commands.console import AsJson, print_json, problem_line, screen
from service.commands.exits import UNUSABLE, say
from service.ingest import read_file
from service.planning.words.missing import missing_in_words


def missing_positions(
    file: Annotated[Path, typer.Argument(metavar="SESSION", help="The session file as it is so far.")],
    *,
    positions: Annotated[
        int | None,
        typer.Option("--positions", "-n", min=2, max=360, help="Positions a run.", show_default="by the steps so far"),
    ] = None,
    runs: Annotated[str, typer.Option(help="both, or direct where the block is not flipped.")] = "both",
    as_json: AsJson = False,
) -> None:
    """Say which positions a session still lacks while it is measured: settings of the stand, or orientations to add."""
    if runs not in ("both", "direct"):
        raise typer.BadParameter(f"--runs is {runs}; give both or direct")
    try:
        found = missing(read_file(file), positions, both_runs=runs == "both")
    except SessionError as fault:
        say(problem_line(file, fault.problems))
        raise typer.Exit(UNUSABLE) from fault
    except OSError as fault:
        say(f"{file}: file: {fault.strerror or fault}; check the name and that it can be read")
        raise typer.Exit(UNUSABLE) from fault
    if as_json:
        print_json(found.to_dict())
    else:
        screen().print(*missing_in_words(found), sep="\n", highlight=False)
