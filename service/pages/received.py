"""The files of the upload form, read whole, and never more than the limit at a time."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, HTTPException, Request
from starlette.datastructures import UploadFile

from service.dependencies import SettingsOf, limited
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
    body = limited(request, settings.max_upload_bytes, ENVELOPE)
    async with body.form(max_files=MOST_FILES, max_fields=10) as form:
        chosen = [file for file in form.getlist("files") if isinstance(file, UploadFile) and file.filename]
        return tuple([FormFile(file.filename or "upload", await file.read()) for file in chosen])


FormFiles = Annotated[tuple[FormFile, ...], Depends(_files)]
