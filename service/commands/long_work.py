"""`imu-health jobs` and `models`: long jobs of a running service, and accepted causes of its models, after which
sessions are computed again. Each command is a row of the table at the end; two need more than one call."""

from enum import StrEnum
from typing import Annotated

import typer
from rich.markup import escape

from estimator.errors import Problem
from estimator.wording import counted
from service.client import connect
from service.commands.api import By, WhyHandled
from service.commands.calls import Answer, Call, ListColumns, Row, in_address
from service.commands.console import DEFAULT_SERVER, AsJson, Out, Server, deliver, print_json, screen
from service.commands.speech import FAILED, output_language, problems_in_words, say, translated
from service.commands.upload import followed
from service.errors import RefusedError, ServiceError
from service.groups.records import Level
from service.jobs.records import KILOBYTE, JobKind, JobState
from service.models.records import Scope

PATHS = {Level.UNIT: "units", Level.TYPE: "unit-types", Level.STAND: "stands"}
COLOURS = {JobState.DONE: "green", JobState.FAILED: "red", JobState.CANCELLED: "yellow"}
JobId = Annotated[int, typer.Argument(metavar="JOB", help="Number of the job.")]
JobBy = Annotated[str, typer.Option("--by", help="Your name, where nobody signs in.")]
Wait = Annotated[bool, typer.Option("--wait", help="Stay until it has ended; exit code 1 where it did not get done.")]
RevisionId = Annotated[int, typer.Argument(metavar="REVISION", help="Number of the revision.")]


class ReportForm(StrEnum):
    """Form of a report."""

    PDF = "pdf"
    XLSX = "xlsx"


def show_job(
    id: JobId, server: Server = DEFAULT_SERVER, as_json: AsJson = False, wait: Wait = False, out: Out = None
) -> None:
    """Show how far a job has come; --out writes the file that it made."""
    with connect(server, language=output_language()) as client:
        job = followed(client, id, quiet=as_json) if wait else client.get(f"/jobs/{id}").json()
        if out is not None:
            deliver(client.get(f"/jobs/{id}/file").content, out)
    print_json(job) if as_json else _show_job(job)
    if wait and job["state"] != JobState.DONE:
        raise typer.Exit(FAILED)


def accept_cause(
    level: Annotated[Level, typer.Argument(help="Whose sessions: of a unit, of a type, or on a stand.")],
    name: Annotated[str, typer.Argument(help="Serial number of the unit, or name of the type or stand.")],
    cause: Annotated[str, typer.Argument(help="Identifier of a cause that these sessions show together.")],
    by: By,
    why: WhyHandled = "",
    sensor: Annotated[list[str] | None, typer.Option(help="Sensor of the finding, where several have it.")] = None,
    server: Server = DEFAULT_SERVER,
    as_json: AsJson = False,
) -> None:
    """Accept what sessions show together; every session that it concerns is computed again."""
    body = {"cause": cause, "sensors": sensor or [], "by": by, "note": why}
    with connect(server, language=output_language()) as client:
        try:
            accepted = client.post(in_address(f"/{PATHS[level]}/{{name}}/diagnosis/accept", {"name": name}), body)
        except RefusedError as refused:
            reasons = "; ".join(f"{problem.field} {problem.message}" for problem in refused.problems)
            raise ServiceError(f"{refused.detail} {reasons}") from refused
        model = client.get(f"/models/{accepted['id']}").json()
    print_json(model) if as_json else _show_model(model)


def _show_job(job: Answer) -> None:
    heading = translated("Job {id}", id=job["id"])
    screen().print(f"{heading}  {_state(job)}  {escape(_work(job))}  {_done(job)}")
    if job["held_up"]:
        say(translated("Delayed, retried automatically: {why}", why=job["held_up"]))
    for failure in job["failures"]:
        say(f"{failure['subject']}: {failure['reason']}" if failure["subject"] else failure["reason"])
    if job["problems"]:
        problems = (Problem(failure["field"], failure["message"], failure["row"]) for failure in job["problems"])
        say(f"{job['subject']}: {problems_in_words(problems)}")
    if job["session"]:
        say(translated("Session {id}", id=job["session"]))


def _done(job: Answer) -> str:
    if job["kind"] == JobKind.UPLOAD:
        done, total = f"{job['done'] / KILOBYTE:.1f}", f"{job['total'] / KILOBYTE:.1f}"
        return translated("{done} of {total} MB", done=done, total=total)
    return translated("{done} of {total}", done=job["done"], total=job["total"])


def _work(job: Answer) -> str:
    if job["kind"] == JobKind.UPLOAD:
        return translated("upload of {file}", file=job["subject"])
    kind = translated(job["kind"])
    if not job["scope"]:
        return translated("{kind} of the fleet", kind=kind)
    return translated("{kind} of {subject}", kind=kind, subject=_subject(job))


def _subject(model: Answer) -> str:
    """``unit BA-017``"""
    return f"{translated(model['scope'].replace('-', ' '))} {model['subject']}"


def _state(job: Answer) -> str:
    state = JobState(job["state"])
    return f"[{COLOURS.get(state, 'blue')}]{translated(state.value)}[/]"


def _show_model(model: Answer) -> None:
    heading = "withdraws revision {id} by {who}, {day}" if model["withdraws"] else "accepted by {who}, {day}"
    done = translated(heading, id=model["withdraws"], who=model["accepted_by"], day=model["accepted_at"][:10])
    parts = {"revision": model["id"], "cause": _cause(model), "subject": _subject(model), "done": done}
    line = translated("Revision {revision}  {cause}  of {subject}, {done}", **parts)
    screen().print(escape(line), highlight=False)
    for recomputation in model["recomputations"]:
        screen().print(f"  [bold]{escape(recomputation['unit'])}[/]  {_outcome(recomputation)}", highlight=False)


def _cause(revision: Answer) -> str:
    sensors = f" ({', '.join(revision['sensors'])})" if revision["sensors"] else ""
    return f"{revision['cause']}{sensors}"


def _outcome(recomputation: Answer) -> str:
    outcome = recomputation["outcome"]
    if outcome is None:
        return translated(recomputation["state"])
    moved = ((m["session"], *(translated(m[when].replace("-", " ")) for when in ("before", "after")))
             for m in outcome["verdicts"])  # fmt: skip
    changes = "; ".join(f"{id} {before} → {after}" for id, before, after in moved)
    done, sessions = outcome["recomputed"], counted(outcome["sessions"], "session")
    done = translated("{done} of {sessions}", done=done, sessions=sessions)
    return f"{done}; {changes or translated('no verdict changes')}"


JOBS = ListColumns(
    "jobs",
    "There is no job.",
    {
        "job": lambda job: str(job["id"]),
        "state": _state,
        "done": _done,
        "what": lambda job: escape(_work(job)),
        "asked for": lambda job: job["asked_at"][:16].replace("T", " "),
        "by": lambda job: escape(job["who"]),
    },
)
MODELS = ListColumns(
    "models",
    "No cause is accepted.",
    {
        "revision": lambda model: str(model["id"]),
        "model of": lambda model: escape(_subject(model)),
        "cause": lambda model: escape(_cause(model)),
        "accepted": lambda model: (
            translated("withdraws {id}", id=model["withdraws"]) if model["withdraws"] else model["accepted_at"][:10]
        ),
    },
    is_paged=True,
)
WANTED_JOBS = {
    "mine": (Annotated[bool, typer.Option("--mine", help="Only what the token's account asked for.")], False),
    "subject": (Annotated[str, typer.Option("--about", help="Only about this unit, unit type or stand.")], ""),
    "limit": (Annotated[int, typer.Option(min=1, max=500, help="How many, the newest first.")], 50),
}
RECALIBRATION = {
    "scope": (Annotated[Scope | None, typer.Option(help="What NAME is; without it the whole fleet.")], None),
    "subject": (Annotated[str, typer.Option("--name", help="Serial number, unit type or stand.")], ""),
    "by": (JobBy, ""),
}
REPORT = {
    "format": (Annotated[ReportForm, typer.Option("--format", help="pdf or xlsx.")], ReportForm.PDF),
    "by": (JobBy, ""),
}

COMMANDS: dict[str, Row] = {
    "jobs": Call("GET /jobs", WANTED_JOBS, JOBS),
    "jobs show": show_job,
    "jobs recalibrate": Call(
        "POST /jobs/recalibration",
        RECALIBRATION,
        _show_job,
        "Have the service compute stored sessions again under the models in force.",
        has_json=True,
    ),
    "jobs report": Call(
        "POST /jobs/report",
        REPORT,
        _show_job,
        "Have the service make a report of the fleet; `imu-health jobs show JOB --wait --out FILE` fetches it.",
        has_json=True,
    ),
    "jobs cancel": Call(
        "POST /jobs/{id}/cancel",
        {"id": JobId, "by": (JobBy, "")},
        _show_job,
        "Stop a job between two pieces of its work; what was done stays.",
        has_json=True,
    ),
    "models": Call("GET /models", {}, MODELS),
    "models accept": accept_cause,
    "models withdraw": Call(
        "POST /models/{id}/withdraw",
        {"id": RevisionId, "by": By, "why": WhyHandled},
        _show_model,
        "Take an accepted cause out of the model again.",
        has_json=True,
        shown_instead="/models/{id}",
    ),
    "models show": Call(
        "GET /models/{id}",
        {"id": RevisionId},
        _show_model,
        "Show a revision: how far its sessions are computed again, and what moved.",
        has_json=True,
    ),
}
