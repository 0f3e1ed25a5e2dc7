"""The command line, `imu-health`. Exit codes: 0 done, 2 unusable input, 1 anything else."""

import sys

import typer
from typer.exceptions import TyperException

from service.commands.calibrate import calibrate_files
from service.commands.console import FAILED, say
from service.commands.convert import convert_files
from service.commands.database import database
from service.commands.report import fleet, report
from service.commands.serve import serve
from service.commands.simulate import simulate_files
from service.commands.upload import upload_files
from service.errors import ServiceError

app = typer.Typer(
    name="imu-health",
    help="In-service health of redundant inertial measurement units.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)
app.command("serve")(serve)
app.command("calibrate")(calibrate_files)
app.command("upload")(upload_files)
app.command("convert")(convert_files)
app.command("fleet")(fleet)
app.command("report")(report)
app.command("simulate")(simulate_files)
app.add_typer(database, name="db")


def main() -> None:
    """Runs a command; what a user can put right is one line on standard error, never a traceback."""
    try:
        code = app(standalone_mode=False)
    except TyperException as fault:
        typer.echo(fault.format_message(), err=True)
        sys.exit(FAILED)
    except (ServiceError, OSError) as fault:
        say(f"imu-health: {fault}")
        sys.exit(FAILED)
    sys.exit(code if isinstance(code, int) else 0)
