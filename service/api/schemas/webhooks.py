"""Addresses that are told of flags and verdicts."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from service.api.schemas.fields import Name
from service.api.schemas.flags import NoticeSchema
from service.records.webhook import DeliveryState

Url = Annotated[str, StringConstraints(pattern=r"^[!-~]+$", max_length=2000)]
Secret = Annotated[str, StringConstraints(pattern=r"^[ -~]+$", min_length=16, max_length=200)]


class NewWebhook(BaseModel):
    """An address that is to be told."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "example": {"url": "https://example.org/hook", "secret": "sixteen or more letters", "by": "K. Ito"}
        },
    )

    url: Url = Field(
        description="Where messages are sent; its host must be among those that the operator allows.",
        json_schema_extra={"pattern": r"^https?://([A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]{1,5})?(/[!-~]*)?$"},
    )
    secret: Secret = Field(description="What messages are signed with, 16 characters or more; never shown again.")
    by: Name = Field(description="Who registers it.")


class WebhookSchema(BaseModel):
    """An address that is told."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the webhook.")
    url: str = Field(description="Where messages are sent.")
    who: str = Field(description="Who registered it.")
    created_at: datetime = Field(description="When, UTC.")


class WebhookList(BaseModel):
    """All addresses that are told."""

    webhooks: list[WebhookSchema] = Field(description="In the order in which they were registered.")


class DeliverySchema(BaseModel):
    """One message to one address."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the delivery.")
    notice: NoticeSchema = Field(description="What the address is told.")
    state: DeliveryState = Field(description="`waiting`, `delivered`, or `failed`: given up.")
    attempts: int = Field(description="How often it was sent.")
    next_at: datetime = Field(description="When it is sent next, UTC; of one that has ended, when it ended.")
    outcome: str = Field(description="What the latest attempt came to.")


class DeliveryList(BaseModel):
    """The latest messages to one address."""

    deliveries: list[DeliverySchema] = Field(description="Newest first.")
