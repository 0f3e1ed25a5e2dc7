"""Flags over HTTP, and the webhooks of programs that are notified of them."""

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, Field, StringConstraints

from service.flags.changes import Assignment, acknowledge_flag, assign_flag, assign_flags, remove_webhook, resolve_flag
from service.flags.changes import register_webhook as register
from service.flags.records import Delivery, Flag, FlagState, Webhook
from service.flags.store import FlagQuery, Flags
from service.flags.view import assignee_meant
from service.flags.webhooks_store import Webhooks
from service.languages.catalogue import said_in
from service.languages.language import Language, asked
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.storage.queries import Store
from service.units.store import Units
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.fields import Body, Limit, LongText, Name, Number, Paged, Reason, Sought, Text, Window, WindowOf
from service.web.problem_document import errors

FlagNumber = Annotated[int, Field(ge=1, le=2_000_000_000)]


class FlagPage(Paged):
    """One page of flags: open ones first, newest first."""

    flags: tuple[Flag, ...] = Field(description="The flags of this page.")


class Assigning(Body, json_schema_extra={"example": {"to": "k.ito", "by": "K. Ito", "why": "knows the stand"}}):
    """Assignment of a flag."""

    to: Text = Field(description="Login or name of an account, any name where there are none; empty for nobody.")
    by: Name = Field(description="Who says so.")
    why: LongText = Field(default="", description="Why.")


class AssigningSeveral(Assigning):
    """Assignment of several flags."""

    flags: list[FlagNumber] = Field(min_length=1, max_length=200, description="Numbers of the flags.")


class Assigned(BaseModel):
    """Result of assigning several flags."""

    changed: int = Field(description="How many have another assignee now; resolved ones are left alone.")


class Handling(Body, json_schema_extra={"example": {"by": "K. Ito", "why": "replacement sensor ordered"}}):
    """Person and reason of an action on a flag."""

    by: Name = Field(description="Who does it.")
    why: Reason = Field(description="Why; what was found or done.")


router = APIRouter(prefix="/flags", tags=["flags"])
WantedState = Annotated[FlagState | None, Query(description="Only flags in this state.")]

ASSIGNED = "Only flags assigned to this login or name; `me`: to whoever asks; `nobody`: to nobody."


def flag_page(store: Store, wanted: FlagQuery, window: Window, language: Language) -> FlagPage:
    """One page of flags as the API answers it; NotFoundError for a unit that there is not."""
    if wanted.unit is not None:
        Units(store).key(wanted.unit)
    found = Flags(store).page(replace(wanted, offset=window.offset, limit=window.limit))
    flags = tuple(said_in(flag, language) for flag in found)
    return FlagPage(flags=flags, **window.place(len(found)))


@router.get("", responses=errors(404, 422))
def list_flags(
    request: Request,
    store: Reading,
    window: WindowOf,
    state: WantedState = None,
    unit: Annotated[Sought | None, Query(description="Only flags of this serial number.")] = None,
    after: Annotated[
        int | None, Query(ge=1, le=2_000_000_000, description="Only those that come after this one.")
    ] = None,
    assigned: Annotated[Sought | None, Query(description=ASSIGNED)] = None,
    *,
    person: PersonOf,
) -> FlagPage:
    """Flags with their lives, open ones first."""
    assignee = assignee_meant(store, assigned or "", person)
    wanted = FlagQuery(unit, state, after=after, assignee=assignee)
    return flag_page(store, wanted, window, asked(request.scope))


@router.post("/assign", responses=errors(400, 404, 422))
def assign_several(given: AssigningSeveral, storage: StorageOf, now: Now, person: PersonOf) -> Assigned:
    """Give several flags to somebody, all or none."""
    said = Assignment(given.to, person.signs(given.by), given.why)
    return Assigned(changed=assign_flags(storage, given.flags, said, now))


@router.post("/{id}/assign", responses=errors(400, 404, 409, 422))
def assign(request: Request, id: Number, given: Assigning, storage: StorageOf, now: Now, person: PersonOf) -> Flag:
    """Say who is to look after the flag."""
    said = Assignment(given.to, person.signs(given.by), given.why)
    return said_in(assign_flag(storage, id, said, now), asked(request.scope))


@router.post("/{id}/acknowledge", responses=errors(400, 404, 409, 422))
def acknowledge(
    request: Request, id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf
) -> Flag:
    """Say that somebody looks after the flag, and why it can stay for now."""
    flag = acknowledge_flag(storage, id, person.signs(handling.by), handling.why, now)
    return said_in(flag, asked(request.scope))


@router.post("/{id}/resolve", responses=errors(400, 404, 409, 422))
def resolve(request: Request, id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Flag:
    """Say that the matter is settled, and how."""
    flag = resolve_flag(storage, id, person.signs(handling.by), handling.why, now)
    return said_in(flag, asked(request.scope))


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


webhooks_router = APIRouter(prefix="/webhooks", tags=["webhooks"])


@webhooks_router.get("", responses=errors())
def list_webhooks(store: Reading) -> WebhookList:
    """Every address that is notified; secrets are not shown."""
    return WebhookList(webhooks=Webhooks(store).every())


@webhooks_router.post("", status_code=201, responses=errors(400, 422))
def register_webhook(new: NewWebhook, storage: StorageOf, settings: SettingsOf, now: Now, person: PersonOf) -> Webhook:
    """Tell an address of flags and verdicts from now on. Its host must be among those that the operator allows;
    `mailto:crew@example.org` is sent e-mail, where the operator named a mail server."""
    who, has_mail = person.signs(new.by), bool(settings.mail_host and settings.mail_from)
    return register(storage, settings.webhook_hosts, new.url, new.secret or "", who=who, now=now, has_mail=has_mail)


@webhooks_router.get("/{id}/deliveries", responses=errors(404, 422))
def list_deliveries(id: Number, store: Reading, limit: Limit = 100) -> DeliveryList:
    """The latest messages to an address, and their outcomes."""
    found = Webhooks(store).deliveries(Webhooks(store).get(id).id, limit)
    return DeliveryList(deliveries=found)


@webhooks_router.delete("/{id}", status_code=204, responses=errors(404, 422))
def delete_webhook(
    id: Number, storage: StorageOf, now: Now, by: Annotated[Name, Query(description="Who removes it.")]
) -> None:
    """Tell an address no more; what was on its way to it is given up."""
    remove_webhook(storage, id, by, now)
