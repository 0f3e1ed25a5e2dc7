"""The pages of administrators: accounts and the audit trail."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Form, Path, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.kit.person import UNNAMED, Account, Role
from service.people.admission import PersonOf
from service.people.changes import AccountChange, add_account, change_account, make_link, require_no_token
from service.people.dependencies import SEE_OTHER, FormText, StorageOf
from service.people.store import Accounts
from service.storage.audit import Audit, AuditCheck, AuditLine
from service.web.application import application_of
from service.web.dependencies import Now, Reading
from service.web.fields import Sought
from service.web.render import render


@dataclass(frozen=True)
class AccountsPage:
    """All accounts, active or not."""

    accounts: tuple[Account, ...]
    roles: tuple[Role, ...]
    login: str
    """Owner of the new link; empty otherwise."""
    link: str


@dataclass(frozen=True)
class AuditView:
    """A part of the trail."""

    lines: tuple[tuple[AuditLine, str], ...]
    """Lines with their details in words."""
    check: AuditCheck | None
    subject: str
    before: int | None
    """Start of the next part."""


def audit_page(lines: Sequence[AuditLine], check: AuditCheck | None, subject: str, limit: int) -> AuditView:
    """The page of some lines of the trail."""
    lines_in_words = tuple((line, _in_words(line)) for line in lines)
    return AuditView(lines_in_words, check, subject, lines[-1].id if len(lines) == limit else None)


def _in_words(line: AuditLine) -> str:
    """``why: wrong cable; before: crew``."""
    return "; ".join(f"{name}: {_plain(value)}" for name, value in line.details.items() if value not in (None, "", {}))


def _plain(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
AUDIT_LINES = 20
"""On a page."""
Login = Annotated[Sought, Path(max_length=60)]


@router.get("/accounts")
def show_accounts(request: Request, store: Reading) -> HTMLResponse:
    """All accounts, active or not."""
    return render(request, "accounts.html", AccountsPage(Accounts(store).every(), tuple(Role), "", ""))


@router.post("/accounts")
def take_account(
    request: Request,
    login: FormText,
    role: Annotated[Role, Form()],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
    name: FormText = "",
) -> HTMLResponse:
    """Makes an account and shows the link with which its owner chooses a password."""
    require_no_token(person)
    made = add_account(storage, login, name, role, now, who=person.signs(UNNAMED))
    return _with_link(request, storage, made.login, make_link(storage, made.login, now, person.signs(UNNAMED)))


@router.post("/accounts/{login}")
def change(
    login: Login,
    name: FormText,
    role: Annotated[Role, Form()],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
    is_active: Annotated[bool, Form()] = False,
) -> RedirectResponse:
    """Changes name, role or whether the account may sign in."""
    change_account(storage, login, AccountChange(name, role, is_active), now, who=person.signs(UNNAMED))
    return RedirectResponse("/accounts", SEE_OTHER)


@router.post("/accounts/{login}/link")
def show_link(request: Request, login: Login, storage: StorageOf, person: PersonOf, now: Now) -> HTMLResponse:
    """Shows a new link for an account."""
    require_no_token(person)
    return _with_link(request, storage, login, make_link(storage, login, now, person.signs(UNNAMED)))


@router.get("/audit")
def show_audit(
    request: Request,
    store: Reading,
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000)] = None,
    subject: Annotated[Sought, Query()] = "",
    check: bool = False,
) -> HTMLResponse:
    """Shows the audit trail, the newest first."""
    wanted = subject.strip()
    lines = Audit(store).page(AUDIT_LINES, before, wanted or None)
    checked = Audit(store).check() if check else None
    return render(request, "audit.html", audit_page(lines, checked, wanted, AUDIT_LINES))


def _with_link(request: Request, storage: StorageOf, login: str, secret: str) -> HTMLResponse:
    address = application_of(request).settings.public_url or str(request.base_url)
    link = f"{address.rstrip('/')}/sign-in/{secret}"
    with storage.database.reading() as store:
        return render(request, "accounts.html", AccountsPage(Accounts(store).every(), tuple(Role), login, link))
