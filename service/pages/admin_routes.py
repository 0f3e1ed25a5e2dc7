"""The addresses of those who administer: accounts and the audit trail."""

from typing import Annotated

from fastapi import APIRouter, Form, Path, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.admission import PersonOf
from service.application import application_of
from service.dependencies import Now, Reading, StorageOf
from service.flows.identity.accounts import AccountChange, add_account, change_account
from service.flows.identity.links import make_link
from service.flows.identity.tokens import require_no_token
from service.pages.admin import AccountsPage, audit_page
from service.pages.forms import NO_NUL, SEE_OTHER
from service.pages.render import render
from service.records.identity import UNNAMED, Role

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
AUDIT_LINES = 100
"""On a page."""
Login = Annotated[str, Path(max_length=60, pattern=NO_NUL)]
Written = Annotated[str, Form(max_length=200, pattern=NO_NUL)]


@router.get("/accounts")
def show_accounts(request: Request, store: Reading) -> HTMLResponse:
    """Everybody who may sign in, or once might."""
    return render(request, "accounts.html", AccountsPage(store.accounts.every(), tuple(Role), "", ""))


@router.post("/accounts")
def take_account(
    request: Request,
    login: Written,
    role: Annotated[Role, Form()],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
    name: Written = "",
) -> HTMLResponse:
    """Makes an account and shows the link with which its owner chooses a password."""
    require_no_token(person)
    made = add_account(storage, login, name, role, now, who=person.signs(UNNAMED))
    return _with_link(request, storage, made.login, make_link(storage, made.login, now, person.signs(UNNAMED)))


@router.post("/accounts/{login}")
def change(
    login: Login,
    name: Written,
    role: Annotated[Role, Form()],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
    is_active: Annotated[bool, Form()] = False,
) -> RedirectResponse:
    """Another name or role, or the account may no longer sign in."""
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
    subject: Annotated[str, Query(max_length=200, pattern=NO_NUL)] = "",
    check: bool = False,
) -> HTMLResponse:
    """Who did what, the newest first."""
    wanted = subject.strip()
    lines = store.audit.page(AUDIT_LINES, before, wanted or None)
    checked = store.audit.check() if check else None
    return render(request, "audit.html", audit_page(lines, checked, wanted, AUDIT_LINES))


def _with_link(request: Request, storage: StorageOf, login: str, secret: str) -> HTMLResponse:
    address = application_of(request).settings.public_url or str(request.base_url)
    link = f"{address.rstrip('/')}/sign-in/{secret}"
    with storage.database.reading() as store:
        return render(request, "accounts.html", AccountsPage(store.accounts.every(), tuple(Role), login, link))
