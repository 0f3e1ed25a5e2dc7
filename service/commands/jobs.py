"""`imu-health jobs`: long work of a running service: listed, asked for, followed and cancelled."""

from enum import StrEnum
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from estimator.errors import Problem
from service.client import connect
from service.commands.console import DEFAULT_SERVER, AsJson, Out, Server, deliver, print_json, screen
from service.commands.exits import say
from service.commands.following import followed
from service.commands.listing import AsLines, FormOf, Listing, table_of
from service.commands.speech import problems_said
from service.jobs.records import KILOBYTE, JobKind, JobState
from service.models.records import Scope

COLOURS = {JobState.DONE: "green", JobState.FAILED: "red", JobState.CANCELLED: "yellow"}
jobs = typer.Typer(
    name="jobs",
    add_completion=False,
    invoke_without_command=True,
    help="Show work that takes long: ask for it, look how far it has come, cancel it.",
)
Id = Annotated[int, typer.Argument(metavar="JOB", help="Number of the job.")]
By = Annotated[str, typer.Option("--by", help="Your name, where nobody signs in.")]
Wait = Annotated[bool, typer.Option("--wait", help="Stay until it has ended; exit code 1 where it did not get done.")]


class ReportForm(StrEnum):
    """What a report can be made as."""

    PDF = "pdf"
    XLSX = "xlsx"


@jobs.callback()
def list_jobs(
    context: typer.Context,
    mine: Annotated[bool, typer.Option("--mine", help="Only what the token's account asked for.")] = False,
    about: Annotated[str, typer.Option(help="Only about this unit, unit type or stand.")] = "",
    limit: Annotated[int, typer.Option(min=1, max=500, help="How many, the newest first.")] = 50,
    server: Server = DEFAULT_SERVER,
    *,
    form: FormOf = None,
    as_json: AsLines = False,
) -> None:
    """Show jobs, the newest first."""
    if context.invoked_subcommand is not None:
        return
    with connect(server) as client:
        found = client.get("/jobs", mine=str(mine).lower(), subject=about, limit=limit).json()["jobs"]
    Listing(form, as_json).show(found, lambda: _table(found) if found else "There is no job.")


@jobs.command("show")
def show_job(
    id: Id, server: Server = DEFAULT_SERVER, as_json: AsJson = False, wait: Wait = False, out: Out = None
) -> None:
    """Show how far a job has come; --out writes the file that it made."""
    with connect(server) as client:
        job = followed(client, id, quiet=as_json) if wait else client.get(f"/jobs/{id}").json()
        if out is not None:
            deliver(client.get(f"/jobs/{id}/file").content, out)
    _tell(job, as_json=as_json)
    if wait and job["state"] != JobState.DONE:
        raise typer.Exit(1)


@jobs.command("recalibrate")
def ask_for_recalibration(
    scope: Annotated[Scope | None, typer.Option(help="What NAME is; without it the whole fleet.")] = None,
    name: Annotated[str, typer.Option(help="Serial number, unit type or stand.")] = "",
    by: By = "",
    server: Server = DEFAULT_SERVER,
    *,
    as_json: AsJson = False,
) -> None:
    """Have the service compute stored sessions again under the models in force."""
    body = {"scope": None if scope is None else scope.value, "subject": name, "by": by}
    with connect(server) as client:
        _tell(client.post("/jobs/recalibration", body), as_json=as_json)


@jobs.command("report")
def ask_for_report(
    format: Annotated[ReportForm, typer.Option("--format", help="pdf or xlsx.")] = ReportForm.PDF,
    by: By = "",
    server: Server = DEFAULT_SERVER,
    as_json: AsJson = False,
) -> None:
    """Have the service make a report of the fleet; `imu-health jobs show JOB --wait --out FILE` fetches it."""
    with connect(server) as client:
        _tell(client.post("/jobs/report", {"format": format.value, "by": by}), as_json=as_json)


@jobs.command("cancel")
def cancel_job(id: Id, by: By = "", server: Server = DEFAULT_SERVER, as_json: AsJson = False) -> None:
    """Stop a job between two pieces of its work; what was done stays."""
    with connect(server) as client:
        _tell(client.post(f"/jobs/{id}/cancel", {"by": by}), as_json=as_json)


def _tell(job: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print_json(job)
        return
    screen().print(_line(job))
    if job["held_up"]:
        say(f"Held up, and tried again by itself: {job['held_up']}")
    for one in job["failures"]:
        say(f"{one['subject']}: {one['reason']}" if one["subject"] else one["reason"])
    if job["problems"]:
        problems = (Problem(one["field"], one["message"], one["row"]) for one in job["problems"])
        say(f"{job['subject']}: {problems_said(problems)}")
    if job["session"]:
        say(f"Session {job['session']}")


def _line(job: dict[str, Any]) -> str:
    return f"Job {job['id']}  {_state(job)}  {escape(_what(job))}  {_done(job)}"


def _done(job: dict[str, Any]) -> str:
    if job["kind"] == JobKind.UPLOAD:
        return f"{job['done'] / KILOBYTE:.1f} of {job['total'] / KILOBYTE:.1f} MB"
    return f"{job['done']} of {job['total']}"


def _what(job: dict[str, Any]) -> str:
    if job["kind"] == JobKind.UPLOAD:
        return f"upload of {job['subject']}"
    return f"{job['kind']} of {job['scope']} {job['subject']}" if job["scope"] else f"{job['kind']} of the fleet"


def _state(job: dict[str, Any]) -> str:
    state = JobState(job["state"])
    return f"[{COLOURS.get(state, 'blue')}]{state.value}[/]"


def _table(found: list[dict[str, Any]]) -> Table:
    table = table_of("job", "state", "done", "what", "asked for", "by", right=("job",))
    for job in found:
        done, asked = _done(job), job["asked_at"][:16].replace("T", " ")
        table.add_row(str(job["id"]), _state(job), done, escape(_what(job)), asked, escape(job["who"]))
    return table
