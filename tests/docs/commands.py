"""Command lines as their commands read them, without carrying anything out."""

import shlex
from typing import Any

import typer

from service.cli import app


def parsed(line: str) -> tuple[str, ...]:
    """The words of the command that a line calls, without `imu-health`; an error where it would not be taken."""
    command: Any = typer.main.get_command(app)
    words: list[str] = []
    left = shlex.split(line.split(" | ")[0].split(" > ")[0].split(" && ")[0])
    while True:
        context = command.make_context(words[-1] if words else "imu-health", list(left))
        left = [*context._protected_args, *context.args]
        if not hasattr(command, "commands") or not left:
            return tuple(words)
        name, command, left = command.resolve_command(context, left)
        words.append(name)
