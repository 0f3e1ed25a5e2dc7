"""What came with an upload: the bytes unchanged, however they were sent, and never more than the limit."""

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from estimator.errors import Problem
from service.api.schemas.sessions import SessionFile
from service.dependencies import SettingsOf, limited
from service.errors import RefusedError

ENVELOPE = 64 * 1024
"""Bytes that a multipart envelope may add to the file."""
NO_FILE = "The form holds no file. Send the session as the body, or as the form's part `file`."


@dataclass(frozen=True)
class ReceivedFile:
    """An uploaded file."""

    content: bytes
    filename: str


async def _received(request: Request, settings: SettingsOf) -> ReceivedFile:
    """The file, from the body or from the part `file` of a form."""
    content_type = request.headers.get("content-type", "").lower()
    is_form = content_type.startswith("multipart/form-data")
    body = limited(request, settings.max_upload_bytes, ENVELOPE if is_form else 0)
    if is_form:
        return await _from_form(body)
    return ReceivedFile(await body.body(), "upload.csv" if "csv" in content_type else "upload.json")


async def _from_form(request: Request) -> ReceivedFile:
    async with request.form(max_files=1, max_fields=10) as form:
        file = form.get("file")
        if not isinstance(file, UploadFile):
            raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
        return ReceivedFile(await file.read(), file.filename or "upload")


Received = Annotated[ReceivedFile, Depends(_received)]

REQUEST_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "A session file, as the body or as the part `file` of a form.",
        "content": {
            "application/json": {"schema": SessionFile.model_json_schema()},
            "text/csv": {"schema": {"type": "string", "description": "imu-session/1 as CSV with metadata."}},
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": {"type": "string", "format": "binary", "description": "The session file."}},
                }
            },
        },
    }
}
"""OpenAPI has no way to say this through a parameter, because the bytes must be kept unchanged."""
