"""The command line, `imu-health`. Exit codes: 0 done, 2 unusable input, 1 anything else.

A command is imported when it is asked for, so that `calibrate` waits for neither a web server nor a database.
"""

import sys
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup
from typer.exceptions import TyperException

from service.commands.console import FAILED, say
from service.errors import ServiceError

COMMANDS = {
    "serve": "serve.serve",
    "calibrate": "calibrate.calibrate_files",
    "diagnose": "diagnose.diagnose_files",
    "template": "template.write_template",
    "upload": "upload.upload_files",
    "convert": "convert.convert_files",
    "fleet": "report.fleet",
    "report": "report.report",
    "usable": "usable.usable",
    "flags": "flags.flags",
    "service": "events.record",
    "session": "records.session",
    "withdraw-service": "records.withdraw_service",
    "note": "events.write_note",
    "certificate": "certificate.certificate",
    "sign": "sign.sign",
    "seal": "sign.seal",
    "customer": "papers.customer",
    "stand-certificate": "papers.stand_certificate",
    "correction": "certificate.correction",
    "simulate": "simulate.simulate_files",
    "plan": "plan.plan_session",
    "parity": "parity.parity",
    "recalibrate": "recalibrate.recalibrate_units",
    "user": "accounts.user",
    "token": "accounts.token",
    "audit": "accounts.audit",
    "db": "database.database",
    "backup": "backup.backup",
    "restore": "backup.restore_backup",
}
"""Every command, and where it is below `service.commands`: a function, or commands of its own."""


class Commands(TyperGroup):
    """The commands by name, each imported when it is wanted."""

    def list_commands(self, ctx: Any) -> list[str]:
        """All names, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """One command; None when there is none of that name."""
        if cmd_name in COMMANDS and cmd_name not in self.commands:
            self.commands[cmd_name] = _command(cmd_name)
        return self.commands.get(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """A name that is none is answered with the ones that are like it, so all must be known."""
        if args[0] not in COMMANDS:
            self.commands.update({name: _command(name) for name in COMMANDS})
        return super().resolve_command(ctx, args)


def _command(name: str) -> Any:
    module, _, member = COMMANDS[name].partition(".")
    found = getattr(import_module(f"service.commands.{module}"), member)
    if isinstance(found, typer.Typer):
        return typer.main.get_command(found)
    single = typer.Typer(add_completion=False, rich_markup_mode="markdown")
    single.command(name)(found)
    return typer.main.get_command(single)


app = typer.Typer(
    name="imu-health",
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)


@app.callback()
def imu_health() -> None:
    """In-service health of redundant inertial measurement units."""


def main() -> None:
    """Runs a command; what a user can put right is one line on standard error, never a traceback."""
    try:
        code = app(standalone_mode=False)
    except TyperException as fault:
        typer.echo(fault.format_message(), err=True)
        sys.exit(FAILED)
    except (ServiceError, OSError) as fault:
        cause = getattr(fault.__cause__, "orig", None)
        say(f"imu-health: {fault}" + (f" ({cause})" if cause else ""))
        sys.exit(FAILED)
    sys.exit(code if isinstance(code, int) else 0)
