"""The files of the upload form, read whole, and never more than the limit at a time."""

from typing import Annotated

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from service.dependencies import PlaceOf, SettingsOf, limited
from service.records.received import SentFile

MOST_FILES = 200
"""In one form: some years of sessions of a unit; it bounds how many parts the form's parser holds."""


async def _files(request: Request, settings: SettingsOf, _: PlaceOf) -> tuple[SentFile, ...]:
    """The chosen files."""
    body = limited(request, settings.max_upload_bytes, is_form=True)
    async with body.form(max_files=MOST_FILES, max_fields=10) as form:
        chosen = [file for file in form.getlist("files") if isinstance(file, UploadFile) and file.filename]
        return tuple([SentFile(file.filename or "upload", await file.read()) for file in chosen])


FormFiles = Annotated[tuple[SentFile, ...], Depends(_files)]
