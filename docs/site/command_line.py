"""Every command with its arguments, options and examples, as its help has them."""

import re
from collections.abc import Iterator
from typing import Any

import typer

from service.cli import app

NAME = "imu-health"
Command = Any
"""Typer's own; it has no public type."""


def command_line_page() -> str:
    """One section a command, in the order of the help."""
    group: Command = typer.main.get_command(app)
    return "\n".join(line for name in group.list_commands(None) for line in _command(group.commands[name], [name]))


def _command(command: Command, way: list[str]) -> Iterator[str]:
    yield f"{'#' * (len(way) + 1)} {' '.join(way)}\n"
    yield f"```text\n{NAME} {' '.join([*way, *_pieces(command)])}\n```\n"
    yield _prose(command.help or "") + "\n"
    yield from _table("argument", [p for p in command.params if p.param_type_name == "argument"])
    yield from _table("option", [p for p in command.params if p.param_type_name == "option"])
    for name, below in getattr(command, "commands", {}).items():
        yield from _command(below, [*way, name])


def _pieces(command: Command) -> Iterator[str]:
    yield "[OPTIONS]"
    if hasattr(command, "commands"):
        yield "COMMAND"
    for one in command.params:
        if one.param_type_name == "argument":
            yield _argument(one) if one.required else f"[{_argument(one)}]"


def _argument(one: Command) -> str:
    name = str(one.metavar or one.name.upper())
    return name.strip("[]…. ") + ("…" if one.nargs == -1 else "")


def _prose(text: str) -> str:
    """The help; what is indented in it is an example of commands."""
    text = re.sub(r"^\x08\n?", "", text, flags=re.MULTILINE).replace("\f", "")
    return re.sub(r"((?:^    .*\n?)+)", lambda found: f"```text\n{_flush(found[1])}```\n", text, flags=re.MULTILINE)


def _flush(block: str) -> str:
    return "".join(f"{line.removeprefix('    ')}\n" for line in block.splitlines())


def _table(what: str, found: list[Command]) -> Iterator[str]:
    if not found:
        return
    yield f"| {what} | meaning | default |\n| --- | --- | --- |"
    for one in found:
        name = (
            f"`{_argument(one)}`"
            if what == "argument"
            else ", ".join(f"`{o}`" for o in [*one.opts, *one.secondary_opts])
        )
        yield f"| {name} | {_cell(one.help or '')} | {_cell(_default(one))} |"
    yield ""


def _default(one: Command) -> str:
    """The default of an option, as the help shows it."""
    if one.required:
        return "needed"
    if isinstance(one.show_default, str):
        return one.show_default
    if one.default in (None, "", (), False) or callable(one.default) or not one.show_default:
        return ""
    return f"`{getattr(one.default, 'value', one.default)}`" if one.default is not True else f"`{one.opts[0]}`"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
