"""The files of the upload form, read whole, and never more than the limit at a time."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, HTTPException, Request
from starlette.datastructures import UploadFile
from starlette.types import Message, Receive

from service.dependencies import SettingsOf
from service.errors import TooLargeError
from service.pages.headers import sent_by_this_site

MOST_FILES = 200
ENVELOPE = 64 * 1024
"""Bytes that the form may add to its files."""


@dataclass(frozen=True)
class FormFile:
    """One file of the form."""

    filename: str
    content: bytes


async def _files(request: Request, settings: SettingsOf) -> tuple[FormFile, ...]:
    """The chosen files; a form that another site sends is refused before it is read."""
    if not sent_by_this_site(request):
        raise HTTPException(403, "This form was sent by another site, so nothing was stored.")
    limited = Request(request.scope, _limited(request.receive, settings.max_upload_bytes))
    async with limited.form(max_files=MOST_FILES, max_fields=10) as form:
        chosen = [file for file in form.getlist("files") if isinstance(file, UploadFile) and file.filename]
        return tuple([FormFile(file.filename or "upload", await file.read()) for file in chosen])


def _limited(receive: Receive, limit: int) -> Receive:
    seen = 0

    async def counted() -> Message:
        nonlocal seen
        message = await receive()
        seen += len(message.get("body", b""))
        if seen > limit + ENVELOPE:
            raise TooLargeError(f"An upload may hold {limit:,} bytes at a time; this one is larger.")
        return message

    return counted


FormFiles = Annotated[tuple[FormFile, ...], Depends(_files)]
