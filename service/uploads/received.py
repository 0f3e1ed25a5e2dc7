"""The files of an upload as they arrive, from a form or the body, within the limits."""

from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass, replace
from io import BytesIO
from typing import Annotated

from fastapi import Depends, Query, Request
from python_multipart.exceptions import FormParserError
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import FormData, Headers, UploadFile
from starlette.exceptions import HTTPException
from starlette.formparsers import MultiPartException, MultiPartParser

from estimator.errors import Problem, SessionError, problem_at
from estimator.json_object import Json
from estimator.message import say
from service.errors import ForbiddenError, RefusedError, TooLargeError
from service.ingest.formats import may_be_long
from service.ingest.layout.envelope import mapping_of
from service.kit.arriving_files import Content, held
from service.kit.limits import in_force
from service.kit.person import Role
from service.kit.text import NUL, OF_A_LINE, OF_LINES, fault_of_text
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.unit_changes import Attaching
from service.sessions.records import MARKS, marks_said
from service.sessions.schema import SESSION_FILE
from service.sessions.sent import Replaced, SentFile
from service.storage.landing import Landing, Landings
from service.web.dependencies import UploadSlotOf, limited
from service.web.fields import LongText, Sought, Text

MOST_FIELDS = 10
"""Parts of a form besides files: a CSRF token, and statements about a corrected file."""
BAD_REQUEST = 400


class Arriving:
    """Receives the files of one request."""

    def __init__(self, request: Request, place: Landings, whole: int, log: int) -> None:
        self._request, self._place = request, place
        self._whole, self._log = whole, log

    async def body(self) -> Content:
        """The body as one file."""
        landing = self._place.new()
        async for data in limited(self._request, self.most, is_form=False).stream():
            await self.take(landing, data)
        return await run_in_threadpool(landing.landed)

    async def form(self, most_files: int) -> FormData:
        """The parts of a form; its files are `LandedFile`."""
        if not self._request.headers.get("content-type", "").lower().startswith("multipart/form-data"):
            return FormData()
        body = limited(self._request, self.most, is_form=True)
        try:
            return await _Form(body, self, most_files).parse()
        except (MultiPartException, FormParserError) as fault:
            raise HTTPException(BAD_REQUEST, str(getattr(fault, "message", "The form cannot be read."))) from fault

    def new(self) -> Landing:
        """A place for one more file."""
        return self._place.new()

    @property
    def most(self) -> int:
        """Bytes of all files of a request."""
        return max(self._whole, self._log)

    async def take(self, landing: Landing, data: bytes) -> None:
        """The next part of a file; TooLargeError above the limit of its format."""
        landing.take(data)
        limit = self.most if may_be_long(landing.start) else self._whole
        if landing.size > limit:
            raise TooLargeError(
                "An upload may hold {limit} bytes at a time; this one is larger. Average or split it.",
                limit=f"{limit:,}",
            )
        if landing.is_due:
            await run_in_threadpool(landing.write)


class LandedFile(UploadFile):
    """A file of a form, stored where it will be read."""

    def __init__(self, arriving: Arriving, filename: str | None, headers: Headers) -> None:
        super().__init__(BytesIO(), size=0, filename=filename, headers=headers)
        self._arriving, self._landing = arriving, arriving.new()

    async def write(self, data: bytes) -> None:
        """The next part."""
        await self._arriving.take(self._landing, data)

    async def content(self) -> Content:
        """The complete file."""
        return await run_in_threadpool(self._landing.landed)


class _Form(MultiPartParser):
    """Starlette's parser with another place for files: the system's temporary folder may be in memory."""

    def __init__(self, body: Request, arriving: Arriving, most_files: int) -> None:
        super().__init__(body.headers, body.stream(), max_files=most_files, max_fields=MOST_FIELDS)
        self._arriving = arriving

    def on_headers_finished(self) -> None:
        """Called at the start of a part."""
        super().on_headers_finished()
        file = self._current_part.file
        if file is not None:
            file.file.close()
            self._current_part.file = LandedFile(self._arriving, file.filename, file.headers)


async def _arriving(request: Request, storage: StorageOf, _: UploadSlotOf) -> AsyncIterator[Arriving]:
    most = in_force()
    with storage.files.arriving() as place:
        yield Arriving(request, place, most.whole, most.log)


async def _attaching(request: Request, storage: StorageOf, _: UploadSlotOf) -> AsyncIterator[Arriving]:
    most = in_force().attached
    with storage.files.arriving() as place:
        yield Arriving(request, place, most, most)


AttachingOf = Annotated[Arriving, Depends(_attaching, scope="function")]
"""Files of an upload that is attached and never read."""
ArrivingOf = Annotated[Arriving, Depends(_arriving, scope="function")]
"""Receives uploads, which are removed after processing."""


LONGEST = {"unit": 200, "session": 200, "text": 2000, "by": 200}
"""Characters of the form's fields, as everywhere."""


@dataclass(frozen=True)
class SentAttachment:
    """A file and its sender."""

    given: Attaching
    who: str


async def _sent_attachment(arriving: AttachingOf, person: PersonOf) -> SentAttachment:
    """The part `file` of a form, with its fields."""
    form = await arriving.form(most_files=1)
    file = form.get("file")
    form_fields = {name: text.strip() if isinstance(text := form.get(name), str) else "" for name in LONGEST}
    who = person.signs(form_fields.pop("by"))
    faults = [
        Problem(name, fault) for name, text in (*form_fields.items(), ("by", who)) if (fault := _fault(name, text))
    ]
    if not who:
        faults.append(Problem("by", "is missing: say who attaches the file"))
    if not isinstance(file, LandedFile) or not file.filename:
        faults.append(Problem("file", "is missing from the form"))
    if faults or not isinstance(file, LandedFile):
        raise RefusedError("The file cannot be attached.", tuple(faults))
    return SentAttachment(Attaching(file.filename or "", await file.content(), **form_fields), who)


def _fault(name: str, text: str) -> str:
    """The reason why a field of the form cannot be stored; empty where it can."""
    if len(text) > LONGEST[name]:
        return say("is longer than {longest} characters", longest=LONGEST[name])
    return fault_of_text(text, OF_LINES if name == "text" else OF_A_LINE) or ""


SentOf = Annotated[SentAttachment, Depends(_sent_attachment)]
"""The attached file."""

NEEDED = "is missing; a session is replaced by somebody and for a reason"
LONGEST_REASON = 2000
"""Characters, as for every reason."""
REPLACES = "Only an engineer replaces a session: upload the file as it is, and ask one."
NO_FILE = "The form contains no file. Send the session as the body, or as the form's part `file`."


Supersedes = Annotated[Sought | None, Query(description="The stored session that this corrected file supersedes.")]
By = Annotated[Text | None, Query(description="Who says so; with `supersedes`.")]
Why = Annotated[LongText | None, Query(description="What was wrong; with `supersedes`.")]
Check = Annotated[
    bool,
    Query(description="Whether it is only a check: judged and kept, and the next calibration is due as it was before."),
]
YES = ("true", "1", "yes", "on")
"""Values of checkboxes."""
FIELDS = ("supersedes", "by", "why")
"""Fields that a form of a corrected file may have too."""


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
    form_fields = {name: text for name in FIELDS if isinstance(text := form.get(name), str)}
    name, mapping_part = file.filename or "upload", form.get("mapping")
    mapping = (
        held(await mapping_part.content()) if isinstance(mapping_part, LandedFile) else str(mapping_part or "").encode()
    )
    marks = marks_said([word for word in MARKS if str(form.get(word, "")).strip().lower() in YES])
    replaces, read_by = _replaced(stated | form_fields), _mapping(mapping, name)
    return SentFile(name, await file.content(), replaces=replaces, mapping=read_by, **marks)


def _mapping(text: bytes, filename: str) -> Json | None:
    """The mapping of a table, from a part of the form, be it a file or not; RefusedError for invalid JSON."""
    if not text.strip():
        return None
    try:
        return mapping_of(text, filename)
    except SessionError as fault:
        raise RefusedError("The mapping cannot be used.", fault.problems) from fault


def _replaced(stated: Mapping[str, str | None]) -> Replaced | None:
    """The session that the file replaces; RefusedError without a name or a reason."""
    session, by, why = ((stated[name] or "").strip() for name in FIELDS)
    if not session:
        return None
    faults = [Problem(name, NEEDED) for name, text in (("by", by), ("why", why)) if not text]
    rules = {"supersedes": (session, NUL), "by": (by, OF_A_LINE), "why": (why, OF_LINES)}
    faults += [Problem(name, fault) for name, rule in rules.items() if (fault := fault_of_text(*rule))]
    if len(why) > LONGEST_REASON:
        faults.append(
            problem_at(
                "why", "is {length} characters long; at most {limit} are kept", length=len(why), limit=LONGEST_REASON
            )
        )
    if faults:
        raise RefusedError("A corrected file states who replaces a session and why.", tuple(faults))
    return Replaced(session, by, why)


FileOf = Annotated[SentFile, Depends(_received)]

REQUEST_BODY: Json = {
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
"""OpenAPI cannot describe this as a parameter, because the bytes must be stored unchanged."""


MOST_FILES = 200
"""Most files in one form: some years of sessions of a unit; limits the number of parts that the parser holds."""


@dataclass(frozen=True)
class Chosen:
    """The chosen files."""

    files: tuple[SentFile, ...]
    is_only_looked_at: bool
    """Whether nothing is to be stored."""


async def _files(arriving: ArrivingOf) -> Chosen:
    form = await arriving.form(MOST_FILES)
    chosen = [file for file in form.getlist("files") if isinstance(file, LandedFile) and file.filename]
    marks = marks_said([word for word in MARKS if form.get(word)])
    files = [SentFile(file.filename or "upload", await file.content(), **marks) for file in chosen]
    return Chosen(tuple(files), bool(form.get("look")))


ChosenOf = Annotated[Chosen, Depends(_files)]
