"""Files that people attach, and remarks on sessions."""

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import Name, Reason
from service.records.event import Attachment


class AttachmentList(BaseModel):
    """Attached files, oldest first."""

    attachments: tuple[Attachment, ...] = Field(description="The files, withdrawn ones too.")


class NewComment(BaseModel):
    """A remark on a session."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"text": "the room was warm", "by": "K. Ito"}}
    )

    text: Reason = Field(description="What is worth knowing.")
    by: Name = Field(description="Who says it.")
