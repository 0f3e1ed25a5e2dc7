"""Uploads on their way in: every part is counted, hashed and put on disk as it comes."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from io import BytesIO
from typing import Annotated

from fastapi import Depends, Request
from python_multipart.exceptions import FormParserError
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import FormData, Headers, UploadFile
from starlette.exceptions import HTTPException
from starlette.formparsers import MultiPartException, MultiPartParser

from estimator.errors import Problem
from estimator.message import say
from service.errors import RefusedError, TooLargeError
from service.ingest.formats import may_be_log
from service.kit.arriving_files import Content
from service.kit.limits import in_force
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.unit_changes import Attaching
from service.storage.landing import Landing, Landings
from service.web.dependencies import PlaceOf, limited

MOST_FIELDS = 10
"""Parts of a form that are no files: a proof, and what a corrected file says of itself."""
BAD_REQUEST = 400


class Arriving:
    """Where the files of one request land."""

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
        """The parts of a form; its files are of the kind `LandedFile`."""
        if not self._request.headers.get("content-type", "").lower().startswith("multipart/form-data"):
            return FormData()
        body = limited(self._request, self.most, is_form=True)
        try:
            return await _Form(body, self, most_files).parse()
        except (MultiPartException, FormParserError) as fault:
            raise HTTPException(BAD_REQUEST, str(getattr(fault, "message", "The form cannot be read."))) from fault

    def new(self) -> Landing:
        """For one more file."""
        return self._place.new()

    @property
    def most(self) -> int:
        """Bytes that the files of a request may have together."""
        return max(self._whole, self._log)

    async def take(self, landing: Landing, data: bytes) -> None:
        """The next part of a file; TooLargeError where it is too much of what it seems to be."""
        landing.take(data)
        most = self.most if may_be_log(landing.start) else self._whole
        if landing.size > most:
            raise TooLargeError(
                say(
                    "An upload may hold {most} bytes at a time; this one is larger. Average or split it.",
                    most=f"{most:,}",
                )
            )
        if landing.is_due:
            await run_in_threadpool(landing.write)


class LandedFile(UploadFile):
    """A file of a form, which goes where it will be read from."""

    def __init__(self, arriving: Arriving, filename: str | None, headers: Headers) -> None:
        super().__init__(BytesIO(), size=0, filename=filename, headers=headers)
        self._arriving, self._landing = arriving, arriving.new()

    async def write(self, data: bytes) -> None:
        """The next part."""
        await self._arriving.take(self._landing, data)

    async def content(self) -> Content:
        """All of it."""
        return await run_in_threadpool(self._landing.landed)


class _Form(MultiPartParser):
    """Starlette's, but for the place of files: not a folder of the system's, which may be in memory."""

    def __init__(self, body: Request, arriving: Arriving, most_files: int) -> None:
        super().__init__(body.headers, body.stream(), max_files=most_files, max_fields=MOST_FIELDS)
        self._arriving = arriving

    def on_headers_finished(self) -> None:
        """A part begins."""
        super().on_headers_finished()
        given = self._current_part.file
        if given is not None:
            given.file.close()
            self._current_part.file = LandedFile(self._arriving, given.filename, given.headers)


async def _arriving(request: Request, storage: StorageOf, _: PlaceOf) -> AsyncIterator[Arriving]:
    most = in_force()
    with storage.files.arriving() as place:
        yield Arriving(request, place, most.whole, most.log)


async def _attaching(request: Request, storage: StorageOf, _: PlaceOf) -> AsyncIterator[Arriving]:
    most = in_force().attached
    with storage.files.arriving() as place:
        yield Arriving(request, place, most, most)


AttachingOf = Annotated[Arriving, Depends(_attaching, scope="function")]
"""The same for a file that is attached and never read."""
ArrivingOf = Annotated[Arriving, Depends(_arriving, scope="function")]
"""Where uploads land, until they were worked on."""


LONGEST = {"unit": 200, "session": 200, "text": 2000, "by": 200}
"""Characters of the form's fields, as everywhere."""


@dataclass(frozen=True)
class SentAttachment:
    """A file, and who sends it."""

    given: Attaching
    who: str


async def _sent(arriving: AttachingOf, person: PersonOf) -> SentAttachment:
    """The part `file` of a form, with what its fields say."""
    form = await arriving.form(most_files=1)
    file = form.get("file")
    said = {name: text.strip() if isinstance(text := form.get(name), str) else "" for name in LONGEST}
    who = person.signs(said.pop("by"))
    faults = [Problem(name, fault) for name, text in (*said.items(), ("by", who)) if (fault := _fault(name, text))]
    if not who:
        faults.append(Problem("by", "is missing: say who attaches the file"))
    if not isinstance(file, LandedFile) or not file.filename:
        faults.append(Problem("file", "is missing from the form"))
    if faults or not isinstance(file, LandedFile):
        raise RefusedError("The file cannot be attached.", tuple(faults))
    return SentAttachment(Attaching(file.filename or "", await file.content(), **said), who)


def _fault(name: str, text: str) -> str:
    """Why a field of the form cannot be kept; empty where it can."""
    if len(text) > LONGEST[name]:
        return say("is longer than {longest} characters", longest=LONGEST[name])
    return "holds a character that cannot be stored" if "\x00" in text else ""


SentOf = Annotated[SentAttachment, Depends(_sent)]
"""The file that was sent."""
