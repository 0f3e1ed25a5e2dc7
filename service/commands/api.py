"""Commands that call a running service: records, services, notes, flags, customers, usability of a unit.
Each is a row of one table at the end of this file; those that need more than one call are functions."""

import re
import webbrowser
from datetime import datetime
from http import HTTPStatus
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from estimator.on_demand import function_on_demand
from estimator.reading.setting import ARCSEC
from service.client import Client, connect
from service.commands.calls import Answer, Call, ListColumns, Row, in_address
from service.commands.console import DEFAULT_SERVER, AsLines, Files, FormOf, ListOutput, Server, screen, usable
from service.commands.speech import output_language, translated
from service.errors import ServiceError
from service.flags.records import FlagState
from service.judging.use import Use, in_words

if TYPE_CHECKING:
    from service.groups.words import place_in_words
else:
    place_in_words = function_on_demand("service.groups.words", "place_in_words")

COLOURS = {FlagState.RAISED: "red", FlagState.ACKNOWLEDGED: "yellow", FlagState.RESOLVED: "green"}
"""Red needs attention."""
USE_COLOURS = {Use.YES: "green", Use.RESERVED: "yellow", Use.NO: "bold red", Use.PENDING: "bold red"}
SESSION_ID = re.compile("[0-9a-f]{20}")
"""Pattern of a session's id; a serial number may match as well."""

By = Annotated[str, typer.Option("--by", help="Your name.")]
Why = Annotated[str, typer.Option("--why", help="Why.")]
WhyHandled = Annotated[str, typer.Option("--why", help="Why; what was found or done.")]
Unit = Annotated[str, typer.Argument(metavar="UNIT", help="Serial number.")]
SessionId = Annotated[str, typer.Argument(metavar="SESSION", help="The session's id.")]
FlagId = Annotated[int, typer.Argument(metavar="FLAG", help="Number of the flag.")]
At = Annotated[datetime | None, typer.Option(help="When, UTC.", show_default="now")]
DAYS = ["%Y-%m-%d"]


def is_session(client: Client, name: str) -> bool:
    """Whether a stored session has this id; any other name is a unit's serial number."""
    if not SESSION_ID.fullmatch(name):
        return False
    try:
        client.get(f"/sessions/{name}")
    except ServiceError as fault:
        if fault.status != HTTPStatus.NOT_FOUND:
            raise
        return False
    return True


def open_page(
    what: Annotated[
        str | None,
        typer.Argument(metavar="[UNIT|SESSION]", help="Serial number, or id of a session.", show_default="fleet"),
    ] = None,
    server: Server = DEFAULT_SERVER,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Print the address alone.")] = True,
) -> None:
    """Open the page of a unit or a session in the browser, and print its address; without one the fleet."""
    with connect(server, language=output_language()) as client:
        if what is None:
            client.get("/me")
            page = "/"
        elif is_session(client, what):
            page = f"/sessions/{what}"
        else:
            page = in_address("/units/{unit}", {"unit": what})
            client.get(page)
    address = server.rstrip("/") + page
    typer.echo(address)
    if browser:
        webbrowser.open(address)


def choose_reference(id: SessionId, by: By, why: Why, server: Server = DEFAULT_SERVER) -> None:
    """Choose and approve a session as what all others of its time are judged against."""
    with connect(server, language=output_language()) as client:
        unit = client.get(f"/sessions/{id}").json()["unit"]
        _show_session(client.post(f"/units/{unit}/reference", {"session": id, "by": by, "why": why}))


def record_service(
    unit: Unit,
    kind: Annotated[str, typer.Argument(help="adjustment, repair, sensor-swap, reference or service.")],
    by: By,
    at: At = None,
    sensor: Annotated[str, typer.Option(help="The sensor that it concerns.", show_default="the whole unit")] = "",
    note: Annotated[str, typer.Option(help="What exactly.")] = "",
    *,
    preview: Annotated[bool, typer.Option("--preview", help="Show what it would change, and store nothing.")] = False,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record a service: a break, after which the unit's next session is its new reference."""
    body = {"kind": kind, "by": by, "sensor": sensor, "note": note} | ({} if at is None else {"at": at.isoformat()})
    path = in_address("/units/{unit}/services", {"unit": unit})
    with connect(server, language=output_language()) as client:
        if preview:
            screen().print(FORESEEN.table(client.post(f"{path}/preview", body)["changes"]))
        else:
            _show_event(client.post(path, body))


def attach_files(
    files: Files,
    to: Annotated[str, typer.Option("--to", metavar="UNIT|SESSION", help="Serial number, or id of a session.")],
    by: By,
    text: Annotated[str, typer.Option("--text", help="What they show.")] = "",
    *,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Attach files to a unit or a session: photographs, protocols. They are kept as they are and never opened."""
    with connect(server, language=output_language()) as client:
        subject = "session" if is_session(client, to) else "unit"
        for file in files:
            form = {subject: to, "by": by, "text": text}
            answer = client.answer("POST", "/attachments", files={"file": (file.name, file.read_bytes())}, data=form)
            attachment = answer.json()
            unit, name = escape(attachment["unit"]), escape(attachment["filename"])
            screen().print(f"[bold]{unit}[/]  attachment {attachment['id']}  {name}")


def write_note(
    unit: Unit,
    text: Annotated[str, typer.Argument(metavar="TEXT", help="What is worth knowing.")],
    by: By,
    at: At = None,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Write a note on a unit's history, or on a session."""
    note = {"text": text, "by": by}
    with connect(server, language=output_language()) as client:
        if not is_session(client, unit):
            when = {} if at is None else {"at": at.isoformat()}
            _show_event(client.post(in_address("/units/{unit}/notes", {"unit": unit}), note | when))
        elif at is None:
            _show_event(client.post(f"/sessions/{unit}/notes", note))
        else:
            raise typer.BadParameter("a note on a session has the date of the session", param_hint="--at")


def stand_dcc(
    stand: Annotated[str, typer.Argument(metavar="STAND", help="Its name, as session files give it.")],
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The certificate, XML.")],
    by: By,
    valid_until: Annotated[
        datetime | None, typer.Option(formats=DAYS, help="The last day, where the document does not state it.")
    ] = None,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Record a stand's certificate from its document."""
    query = {"by": by} | ({} if valid_until is None else {"valid_until": valid_until.date().isoformat()})
    with usable(file), connect(server, language=output_language()) as client:
        address = in_address("/stands/{stand}/certificate-document", {"stand": stand})
        sent = {"content": file.read_bytes(), "headers": {"Content-Type": "application/xml"}, "params": query}
        read = client.answer("PUT", address, **sent).json()
    kept = read["certificate"]
    screen().print(f"[bold]{escape(kept['number'])}[/]  {escape(kept['issued_by'])}  {kept['valid_until']}")
    for error in read["errors"]:
        screen().print(f"  {error['name']}  {error['sigma'] / ARCSEC:.3g} arcsec")


def list_flags(
    context: typer.Context,
    unit: Annotated[str | None, typer.Option(help="Only of this serial number.")] = None,
    state: Annotated[FlagState | None, typer.Option(help="Only in this state.", show_default="open ones")] = None,
    assigned: Annotated[
        str | None, typer.Option(help="Only of this login or name; `me`: of the token's account; `nobody`.")
    ] = None,
    server: Server = DEFAULT_SERVER,
    *,
    form: FormOf = None,
    as_json: AsLines = False,
) -> None:
    """Show flags; without a state those that are open, which the API has first."""
    if context.invoked_subcommand is not None:
        return
    filters, listing = {"unit": unit, "state": state, "assigned": assigned}, ListOutput(form, as_json)
    with connect(server, language=listing.language) as client:
        found = client.every("/flags", "flags", limit=1000, **{name: value for name, value in filters.items() if value})
        rows = list(found if state else takewhile(lambda flag: flag["state"] != FlagState.RESOLVED, found))
    columns = ListColumns("flags", "There is none." if state else "No flag is open.", FLAG_CELLS)
    listing.show(rows, lambda: columns.table(rows))


def assign_flags(
    ids: Annotated[list[int], typer.Argument(metavar="FLAG...", help="Numbers of the flags.", show_default=False)],
    to: Annotated[str, typer.Option("--to", help="Login or name; empty for nobody in particular.")],
    by: By,
    why: Why = "",
    *,
    server: Server = DEFAULT_SERVER,
) -> None:
    """Say who is to look after flags; `imu-health flags --assigned NAME` finds them."""
    with connect(server, language=output_language()) as client:
        for id in ids:
            _show_flag(client.post(f"/flags/{id}/assign", {"to": to, "by": by, "why": why}))


def _show_session(session: Answer) -> None:
    reference = f"  {translated('reference')}" if session["is_reference"] else ""
    heading, state = translated("Session {id}", id=session["id"]), translated(session["state"])
    line = f"{heading}  [bold]{escape(session['unit'])}[/]  {state}{reference}"
    screen().print(f"{line}  {escape(session['reason'])}")


def _show_withdrawn_service(record: Answer) -> None:
    heading, kind = translated("Service {id}", id=record["id"]), translated(record["kind"].replace("-", " "))
    screen().print(f"{heading}  [bold]{escape(record['unit'])}[/]  {kind}  {translated(record['state'])}")


def _show_event(event: Answer) -> None:
    kind = translated(event.get("kind", "note").replace("-", " "))
    said = translated("{what} {id} recorded", what=kind, id=event["id"])
    screen().print(f"[bold]{escape(event['unit'])}[/]  {event['at'][:10]}  {said}")


def _show_flag(flag: Answer) -> None:
    unit, summary = escape(flag["unit"]), escape(translated(flag["summary"]))
    heading = translated("Flag {id}", id=flag["id"])
    screen().print(f"{heading}  [bold]{unit}[/]  {_flag_state(flag)}  {summary}")


def _flag_state(flag: Answer) -> str:
    state = FlagState(flag["state"])
    return f"[{COLOURS[state]}]{translated(state.value)}[/]"


def _show_customer(customer: Answer) -> None:
    where = escape(customer["address"] or translated("address not stated"))
    screen().print(f"[bold]{escape(customer['unit'])}[/]  {escape(customer['name'])}, {where}")


def _show_stand(stand: Answer) -> None:
    until = translated("valid until {day}", day=stand["valid_until"])
    screen().print(f"[bold]{escape(stand['stand'])}[/]  {escape(stand['number'])}, {until}")


def _show_usable(answer: Answer) -> None:
    colour = USE_COLOURS[Use(answer["use"])]
    word = translated(in_words(Use(answer["use"]), answer["action"]))
    lines = (
        answer["why"],
        *answer["reasons"][1:],
        *(f"{translated('But')}: {line}" for line in answer["reservations"]),
    )
    head = f"[bold]{escape(answer['unit'])}[/]  [{colour}]{escape(word)}[/]"
    screen().print(head, *(escape(translated(line)) for line in lines), sep="\n  ")


FLAG_CELLS = {
    "flag": lambda flag: str(flag["id"]),
    "unit": lambda flag: escape(flag["unit"]),
    "state": _flag_state,
    "since": lambda flag: flag["raised_at"][:10],
    "who": lambda flag: escape(flag["assignee"]),
    "where": lambda flag: escape(translated(place_in_words(flag["place"], flag["subject"] or flag["unit"]))),
    "what": lambda flag: escape(translated(f"{flag['summary']} {flag['proposal']}".strip())),
}
AFFECTED = ListColumns(
    "certificates",
    "No certificate rests on it.",
    {
        "certificate": lambda found: escape(found["number"]),
        "unit": lambda found: escape(found["unit"]),
        "measured on": lambda found: found["started_at"][:10],
        "issued on": lambda found: found["issued_at"][:10],
        "session": lambda found: found["session"],
    },
    is_numbered=False,
)
FORESEEN = ListColumns(
    "changes",
    "No verdict, date or flag would change.",
    {
        "what": lambda change: escape(change["what"]),
        "now": lambda change: escape(change["before"]),
        "with the service": lambda change: escape(change["after"]),
    },
    is_numbered=False,
)
CUSTOMER = {
    "unit": Unit,
    "name": Annotated[str, typer.Argument(metavar="NAME", help="For whom it is calibrated.")],
    "by": By,
    "address": (Annotated[str, typer.Option(help="Where they can be reached.")], ""),
}
STAND = Annotated[str, typer.Argument(metavar="STAND", help="Its name, as session files give it.")]
STAND_CERTIFICATE = {
    "stand": STAND,
    "number": Annotated[str, typer.Option(help="As printed on the certificate.")],
    "issued_by": Annotated[str, typer.Option(help="The laboratory that calibrated the stand.")],
    "issued_on": Annotated[datetime, typer.Option(formats=DAYS, help="From this day on it speaks for the stand.")],
    "valid_until": Annotated[datetime, typer.Option(formats=DAYS, help="The last day on which it holds.")],
    "by": By,
}
RESTING = {
    "stand": STAND,
    "since": (Annotated[datetime | None, typer.Option(formats=DAYS, help="First day of measurement.")], None),
    "until": (Annotated[datetime | None, typer.Option(formats=DAYS, help="Last day of measurement.")], None),
}
ON_SESSION = {"id": SessionId, "by": By, "why": Why}
ON_SERVICE = {
    "number": Annotated[int, typer.Argument(metavar="SERVICE", help="Number of the service.")],
    "by": By,
    "why": Why,
}
ON_FLAG = {"id": FlagId, "by": By, "why": WhyHandled}

COMMANDS: dict[str, Row] = {
    "session withdraw": Call(
        "POST /sessions/{id}/withdraw",
        ON_SESSION,
        _show_session,
        "Withdraw a session: it stays readable, and no longer counts for its unit.",
    ),
    "session accept": Call(
        "POST /sessions/{id}/accept",
        ON_SESSION,
        _show_session,
        "Say that a session counts that was questioned, withdrawn or superseded.",
    ),
    "session reference": choose_reference,
    "withdraw-service": Call("POST /services/{number}/withdraw", ON_SERVICE, _show_withdrawn_service),
    "service": record_service,
    "note": write_note,
    "attach": attach_files,
    "flags": list_flags,
    "flags acknowledge": Call(
        "POST /flags/{id}/acknowledge",
        ON_FLAG,
        _show_flag,
        "Say that somebody looks after the flag, and why it can stay for now.",
    ),
    "flags resolve": Call("POST /flags/{id}/resolve", ON_FLAG, _show_flag, "Say that the matter is settled, and how."),
    "flags assign": assign_flags,
    "customer": Call("PUT /units/{unit}/customer", CUSTOMER, _show_customer),
    "stand-certificate": Call("PUT /stands/{stand}/certificate", STAND_CERTIFICATE, _show_stand),
    "stand-dcc": stand_dcc,
    "stand-affected": Call("GET /stands/{stand}/resting-certificates", RESTING, AFFECTED),
    "usable": Call(
        "GET /units/{unit}/usable",
        {"unit": Unit},
        _show_usable,
        has_json=True,
        is_failure=lambda answer: not answer["usable"],
    ),
    "open": open_page,
}
