"""What came with an upload: the bytes unchanged, however they were sent, and never more than the limit."""

from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from estimator.errors import Problem
from service.api.schemas.sessions import SessionFile
from service.dependencies import SettingsOf, limited
from service.errors import RefusedError
from service.records.received import SentFile

NO_FILE = "The form holds no file. Send the session as the body, or as the form's part `file`."


async def _received(request: Request, settings: SettingsOf) -> SentFile:
    """The file, from the body or from the part `file` of a form."""
    content_type = request.headers.get("content-type", "").lower()
    is_form = content_type.startswith("multipart/form-data")
    body = limited(request, settings.max_upload_bytes, is_form=is_form)
    if is_form:
        return await _from_form(body)
    return SentFile("upload.csv" if "csv" in content_type else "upload.json", await body.body())


async def _from_form(request: Request) -> SentFile:
    async with request.form(max_files=1, max_fields=10) as form:
        file = form.get("file")
        if not isinstance(file, UploadFile):
            raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
        return SentFile(file.filename or "upload", await file.read())


FileOf = Annotated[SentFile, Depends(_received)]
"""The uploaded file."""

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
