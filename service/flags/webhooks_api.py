"""Webhooks over HTTP."""

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field, StringConstraints

from service.flags.changes import register_webhook as register
from service.flags.changes import remove_webhook
from service.flags.records import Delivery, Webhook
from service.flags.webhooks_store import Webhooks
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.fields import Body, Limit, Name, Number
from service.web.problem_document import errors

Url = Annotated[str, StringConstraints(pattern=r"^[!-~]+$", max_length=2000)]
Secret = Annotated[str, StringConstraints(pattern=r"^[ -~]+$", min_length=16, max_length=200)]


class NewWebhook(
    Body,
    json_schema_extra={
        "example": {"url": "https://example.org/hook", "secret": "sixteen or more letters", "by": "K. Ito"}
    },
):
    """An address to notify."""

    url: Url = Field(
        description="Where messages are sent; its host must be among those that the operator allows.",
        json_schema_extra={
            "pattern": r"^(https?://([A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]{1,5})?(/[!-~]*)?|mailto:[!-~]+@[A-Za-z0-9.-]+)$"
        },
    )
    secret: Secret | None = Field(
        default=None, description="What messages to a host are signed with, 16 characters or more; never shown again."
    )
    by: Name = Field(description="Who registers it.")


class WebhookList(BaseModel):
    """All addresses that are notified."""

    webhooks: tuple[Webhook, ...] = Field(description="In the order in which they were registered.")


class DeliveryList(BaseModel):
    """The latest messages to one address."""

    deliveries: tuple[Delivery, ...] = Field(description="Newest first.")


router = APIRouter(prefix="/webhooks", tags=["webhooks"])


@router.get("", responses=errors())
def list_webhooks(store: Reading) -> WebhookList:
    """Every address that is notified; secrets are not shown."""
    return WebhookList(webhooks=Webhooks(store).every())


@router.post("", status_code=201, responses=errors(400, 422))
def register_webhook(new: NewWebhook, storage: StorageOf, settings: SettingsOf, now: Now, person: PersonOf) -> Webhook:
    """Tell an address of flags and verdicts from now on. Its host must be among those that the operator allows;
    `mailto:crew@example.org` is sent e-mail, where the operator named a mail server."""
    who, has_mail = person.signs(new.by), bool(settings.mail_host and settings.mail_from)
    return register(storage, settings.webhook_hosts, new.url, new.secret or "", who=who, now=now, has_mail=has_mail)


@router.get("/{id}/deliveries", responses=errors(404, 422))
def list_deliveries(id: Number, store: Reading, limit: Limit = 100) -> DeliveryList:
    """The latest messages to an address, and what became of them."""
    found = Webhooks(store).deliveries(Webhooks(store).get(id).id, limit)
    return DeliveryList(deliveries=found)


@router.delete("/{id}", status_code=204, responses=errors(404, 422))
def delete_webhook(
    id: Number, storage: StorageOf, now: Now, by: Annotated[Name, Query(description="Who removes it.")]
) -> None:
    """Tell an address no more; what was on its way to it is given up."""
    remove_webhook(storage, id, by, now)
