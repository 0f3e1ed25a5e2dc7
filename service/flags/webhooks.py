"""Addresses are registered and removed."""

from datetime import datetime

import httpx

from estimator.errors import Problem
from estimator.message import say
from service.errors import RefusedError
from service.flags.records import Webhook
from service.flags.webhooks_store import Webhooks
from service.storage import Storage
from service.storage.audit import Audit

SCHEMES = ("http", "https")
"""That a message can be sent by."""


def register_webhook(
    storage: Storage, hosts: tuple[str, ...], url: str, secret: str, *, who: str, now: datetime
) -> Webhook:
    """Registers an address; RefusedError unless its host may be called."""
    fault = fault_of(url, hosts)
    if fault:
        raise RefusedError("The webhook cannot be registered.", (Problem("url", fault),))
    with storage.database.writing() as store:
        webhook = Webhooks(store).add(url, secret, who, now)
        Audit(store).write(now, who, "add webhook", str(webhook.id), {"url": url})
        return webhook


def fault_of(url: str, hosts: tuple[str, ...]) -> str:
    """Why an address may not be called; empty where it may.

    It is read by the library that will call it, so that no spelling of a host means one thing here and another there.
    """
    try:
        parsed = httpx.URL(url)
    except (httpx.InvalidURL, ValueError):
        return "is not an address; write it like https://example.org/hook"
    if parsed.scheme not in SCHEMES or not parsed.host:
        return "must begin with https:// or http:// and name a host"
    if parsed.userinfo:
        return "holds a user name or a password; leave them out, every message is signed with the secret"
    host = f"[{parsed.host}]" if ":" in parsed.host else parsed.host
    wanted = host if parsed.port is None else f"{host}:{parsed.port}"
    if wanted.lower() not in {allowed.lower() for allowed in hosts}:
        return say(
            "leads to {wanted}, which this service may not call; whoever runs it can allow it with "
            "IMU_HEALTH_WEBHOOK_HOSTS",
            wanted=wanted,
        )
    return ""


def remove_webhook(storage: Storage, id: int, who: str, now: datetime) -> None:
    """Tells an address no more."""
    with storage.database.writing() as store:
        url = Webhooks(store).get(id).url
        Webhooks(store).remove(id, now)
        Audit(store).write(now, who, "remove webhook", str(id), {"url": url})
