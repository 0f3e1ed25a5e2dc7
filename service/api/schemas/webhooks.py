"""Addresses that are told of flags and verdicts."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from service.api.schemas.fields import Name
from service.records.webhook import Delivery, Webhook

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


class WebhookList(BaseModel):
    """All addresses that are told."""

    webhooks: tuple[Webhook, ...] = Field(description="In the order in which they were registered.")


class DeliveryList(BaseModel):
    """The latest messages to one address."""

    deliveries: tuple[Delivery, ...] = Field(description="Newest first.")
