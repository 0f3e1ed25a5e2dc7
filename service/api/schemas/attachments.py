"""Files that people attach, and remarks on sessions."""

from datetime import datetime

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.events import WithdrawalSchema
from service.api.schemas.fields import Name, Reason


class AttachmentSchema(BaseModel):
    """A file that somebody attached; never changed."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the attachment.")
    unit: str = Field(description="Serial number of the unit.")
    session: str | None = Field(description="The session that it is attached to; null for the unit as a whole.")
    filename: str = Field(description="What the file was called.")
    size: int = Field(description="Bytes.")
    sha256: str = Field(description="SHA-256 of the bytes.")
    text: str = Field(description="What it shows.")
    who: str = Field(description="Who attached it.")
    at: datetime = Field(description="When, UTC.")
    withdrawal: WithdrawalSchema | None = Field(description="Why it is given out no more; null while it is.")


class AttachmentList(BaseModel):
    """Attached files, oldest first."""

    attachments: list[AttachmentSchema] = Field(description="The files, withdrawn ones too.")


class NewComment(BaseModel):
    """A remark on a session."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"text": "the room was warm", "by": "K. Ito"}}
    )

    text: Reason = Field(description="What is worth knowing.")
    by: Name = Field(description="Who says it.")
