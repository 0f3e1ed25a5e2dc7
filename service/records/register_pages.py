"""The page of the register, and the forms that enter, move, retire and put back a unit."""

from dataclasses import dataclass
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.errors import Problem
from service.errors import RefusedError
from service.people.dependencies import NOT_BLANK, SEE_OTHER, By, Key, OptionalText, StorageOf, Why
from service.records.pages import At
from service.records.register import Entered, Entering, enter, move_unit
from service.records.register_api import import_register
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry
from service.units.register_file import COLUMNS
from service.uploads.received import SentOf
from service.web.dependencies import Now, Reading
from service.web.fields import NO_NUL
from service.web.render import render

MOST_TYPES = 500
"""Names that the form offers."""
Short = Annotated[str, Form(max_length=200, pattern=NO_NUL)]
Named = Annotated[str, Form(max_length=200, pattern=NOT_BLANK)]


@dataclass(frozen=True)
class RegisterPage:
    """The forms of the register, and what became of a list that was imported."""

    types: tuple[str, ...]
    entered: Entered | None = None
    refused: str = ""
    problems: tuple[Problem, ...] = ()
    columns: tuple[str, ...] = COLUMNS


router = APIRouter(include_in_schema=False)


@router.get("/register", response_class=HTMLResponse)
def show_register(request: Request, store: Reading) -> HTMLResponse:
    """The forms."""
    types = tuple(unit_type.name for unit_type in UnitTypes(store).page(0, MOST_TYPES))
    return render(request, "register.html", RegisterPage(types))


@router.post("/register")
def enter_unit(
    serial: Named, unit_type: Named, by: By, storage: StorageOf, now: Now,
    *, owner: Short = "", location: Short = "", custodian: Short = "", note: OptionalText = "",
) -> RedirectResponse:  # fmt: skip
    """Enters one unit."""
    texts = (text.strip() for text in (serial, unit_type, owner, location, custodian, note))
    entry = NewEntry(*texts)
    enter(storage, (entry,), Entering(by, now))
    return RedirectResponse(f"/units/{quote(entry.serial)}#register", SEE_OTHER)


@router.post("/register/import", response_class=HTMLResponse)
def import_units(request: Request, sent: SentOf, storage: StorageOf, now: Now) -> HTMLResponse:
    """Enters the units of a table; the page again with what became of it."""
    with storage.database.reading() as store:
        types = tuple(unit_type.name for unit_type in UnitTypes(store).page(0, MOST_TYPES))
    try:
        page = RegisterPage(types, import_register(storage, sent, now))
    except RefusedError as refusal:
        page = RegisterPage(types, None, refusal.detail, refusal.problems)
        return render(request, "register.html", page, refusal.status)
    return render(request, "register.html", page)


@router.post("/units/{serial:path}/moves")
def move(
    serial: Key, location: Short, custodian: Short, by: By, storage: StorageOf, now: Now,
    *, at: At = None, remark: OptionalText = "",
) -> RedirectResponse:  # fmt: skip
    """Records where a unit is and who has it."""
    move_unit(storage, serial, Move(location.strip(), custodian.strip(), remark), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}#register", SEE_OTHER)


@router.post("/units/{serial:path}/retire")
def retire(serial: Key, by: By, why: Why, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Retires a unit."""
    move_unit(storage, serial, Move(remark=why, step=CustodyStep.RETIRED), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}", SEE_OTHER)


@router.post("/units/{serial:path}/return")
def put_back(serial: Key, by: By, why: Why, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Puts a unit back into use."""
    move_unit(storage, serial, Move(remark=why, step=CustodyStep.RETURNED), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}", SEE_OTHER)
