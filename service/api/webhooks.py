"""Webhooks: addresses that are told of flags and verdicts."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Limit, Name, Number
from service.api.schemas.problem import errors
from service.api.schemas.webhooks import DeliveryList, NewWebhook, WebhookList
from service.dependencies import Now, Reading, SettingsOf, StorageOf
from service.flows.register_webhook import register_webhook as register
from service.flows.remove_webhook import remove_webhook
from service.records.webhook import Webhook

router = APIRouter(prefix="/webhooks", tags=["webhooks"])


@router.get("", responses=errors())
def list_webhooks(store: Reading) -> WebhookList:
    """Every address that is told; secrets are not shown."""
    return WebhookList(webhooks=store.webhooks.every())


@router.post("", status_code=201, responses=errors(400, 422))
def register_webhook(new: NewWebhook, storage: StorageOf, settings: SettingsOf, now: Now, person: PersonOf) -> Webhook:
    """Tell an address of flags and verdicts from now on. Its host must be among those that the operator allows."""
    webhook = register(storage, settings.webhook_hosts, new.url, new.secret, who=person.signs(new.by), now=now)
    return webhook


@router.get("/{id}/deliveries", responses=errors(404, 422))
def list_deliveries(id: Number, store: Reading, limit: Limit = 100) -> DeliveryList:
    """The latest messages to an address, and what became of them."""
    found = store.webhooks.deliveries(store.webhooks.get(id).id, limit)
    return DeliveryList(deliveries=found)


@router.delete("/{id}", status_code=204, responses=errors(404, 422))
def delete_webhook(
    id: Number, storage: StorageOf, now: Now, by: Annotated[Name, Query(description="Who removes it.")]
) -> None:
    """Tell an address no more; what was on its way to it is given up."""
    remove_webhook(storage, id, by, now)
