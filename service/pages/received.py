"""The files of the upload form, as they land, and never more than the limits at a time."""

from typing import Annotated

from fastapi import Depends

from service.arriving import ArrivingOf, LandedFile
from service.records.received import SentFile

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
