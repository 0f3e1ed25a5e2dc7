"""The files of an upload as they arrive, from the form or over HTTP, never more than the limits."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

from fastapi import Depends, Query, Request

from estimator.errors import Problem, SessionError
from estimator.message import say
from service.errors import ForbiddenError, RefusedError
from service.ingest.layout.envelope import mapping_of
from service.kit.arriving_files import Replaced, SentFile, held
from service.kit.person import Role
from service.people.admission import PersonOf
from service.sessions.schema import SESSION_FILE
from service.uploads.arriving import Arriving, ArrivingOf, LandedFile
from service.web.fields import LongText, Text

NEEDED = "is missing; a session is replaced by somebody and for a reason"
LONGEST_WHY = 2000
"""Characters, as for every reason."""
REPLACES = "A session is replaced by an engineer: upload the file as it is, and tell one."
NO_FILE = "The form holds no file. Send the session as the body, or as the form's part `file`."


Supersedes = Annotated[
    Text | None, Query(description="The stored session that this corrected file stands for from now on.")
]
By = Annotated[Text | None, Query(description="Who says so; with `supersedes`.")]
Why = Annotated[LongText | None, Query(description="What was wrong; with `supersedes`.")]
Check = Annotated[
    bool,
    Query(description="Whether it is only a check: judged and kept, and the next calibration is due as it was before."),
]
YES = ("true", "1", "yes", "on")
"""As forms say it."""
FIELDS = ("supersedes", "by", "why")
"""That a corrected file may bring as parts of its form too."""


async def _received(
    request: Request,
    arriving: ArrivingOf,
    person: PersonOf,
    *,
    supersedes: Supersedes = None,
    by: By = None,
    why: Why = None,
    check: Check = False,
) -> SentFile:
    """The file, from the body or from the part `file` of a form."""
    sent = await _sent(request, arriving, {"supersedes": supersedes, "by": person.signs(by or ""), "why": why})
    sent = replace(sent, is_check=sent.is_check or check)
    if sent.replaces is None:
        return sent
    if not person.may(Role.ENGINEER):
        raise ForbiddenError(REPLACES)
    return replace(sent, replaces=replace(sent.replaces, who=person.signs(sent.replaces.who)))


async def _sent(request: Request, arriving: Arriving, stated: dict[str, str | None]) -> SentFile:
    content_type = request.headers.get("content-type", "").lower()
    if content_type.startswith("multipart/form-data"):
        return await _from_form(arriving, stated)
    name = "upload.csv" if "csv" in content_type else "upload.json"
    return SentFile(name, await arriving.body(), replaces=_replaced(stated))


async def _from_form(arriving: Arriving, stated: dict[str, str | None]) -> SentFile:
    form = await arriving.form(most_files=2)
    file = form.get("file")
    if not isinstance(file, LandedFile):
        raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
    own = {name: text for name in FIELDS if isinstance(text := form.get(name), str)}
    name, sent = file.filename or "upload", form.get("mapping")
    mapping = held(await sent.content()) if isinstance(sent, LandedFile) else str(sent or "").encode()
    is_check = str(form.get("check", "")).strip().lower() in YES
    replaces, read_by = _replaced(stated | own), _mapping(mapping, name)
    return SentFile(name, await file.content(), is_check=is_check, replaces=replaces, mapping=read_by)


def _mapping(text: bytes, filename: str) -> dict[str, Any] | None:
    """How the table is read, from a part of the form, be it a file or not; RefusedError where it is no JSON."""
    if not text.strip():
        return None
    try:
        return mapping_of(text, filename)
    except SessionError as fault:
        raise RefusedError("The mapping cannot be used.", fault.problems) from fault


def _replaced(stated: Mapping[str, str | None]) -> Replaced | None:
    """What the file stands for; RefusedError where nobody says so or why."""
    known, by, why = ((stated[name] or "").replace("\x00", "").strip() for name in FIELDS)
    if not known:
        return None
    faults = [Problem(name, NEEDED) for name, text in (("by", by), ("why", why)) if not text]
    if len(why) > LONGEST_WHY:
        faults.append(
            Problem(
                "why",
                say("is {why} characters long; at most {longest_why} are kept", why=len(why), longest_why=LONGEST_WHY),
            )
        )
    if faults:
        raise RefusedError("A corrected file says who replaces a session and why.", tuple(faults))
    return Replaced(known, by, why)


FileOf = Annotated[SentFile, Depends(_received)]
"""The uploaded file."""

REQUEST_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "A session file, as the body or as the part `file` of a form.",
        "content": {
            "application/json": {"schema": SESSION_FILE},
            "text/csv": {"schema": {"type": "string", "description": "imu-session/1 as CSV with metadata."}},
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": {"type": "string", "format": "binary", "description": "The session file."}}
                    | {name: {"type": "string"} for name in FIELDS}
                    | {"check": {"type": "boolean", "description": "Whether it is only a check."}}
                    | {"mapping": {"type": "string", "description": "imu-mapping/1, for a table of one's own layout."}},
                }
            },
        },
    }
}
"""OpenAPI has no way to say this through a parameter, because the bytes must be kept unchanged."""


MOST_FILES = 200
"""In one form: some years of sessions of a unit; it bounds how many parts the form's parser holds."""


async def _files(arriving: ArrivingOf) -> tuple[SentFile, ...]:
    """The chosen files."""
    form = await arriving.form(MOST_FILES)
    chosen = [file for file in form.getlist("files") if isinstance(file, LandedFile) and file.filename]
    is_check = bool(form.get("check"))
    return tuple([SentFile(file.filename or "upload", await file.content(), is_check=is_check) for file in chosen])


FormFiles = Annotated[tuple[SentFile, ...], Depends(_files)]
"""The files that were sent."""
