"""The forms of what becomes of records: sessions and services withdrawn, sessions accepted or chosen as reference."""

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form
from fastapi.responses import RedirectResponse

from service.dependencies import Now, ReceptionOf
from service.flows.accept_session import accept_session
from service.flows.choose_reference import choose_reference
from service.flows.correct_session import correct_session
from service.flows.receive import deriving
from service.flows.set_check import set_check
from service.flows.supersede_session import supersede_session
from service.flows.withdraw_service import withdraw_service
from service.flows.withdraw_session import withdraw_session
from service.pages.forms import SAYS_SOMETHING, SEE_OTHER, By, Key, Number, Why
from service.records.received import Replaced
from service.records.state import Step

router = APIRouter(include_in_schema=False)


@router.post("/sessions/{id}/withdraw")
def withdraw(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session is taken back."""
    withdraw_session(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/sessions/{id}/accept")
def accept(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session counts."""
    accept_session(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/sessions/{id}/check")
def mark_check(
    id: Key, by: By, why: Why, reception: ReceptionOf, now: Now, *, is_check: Annotated[bool, Form()] = False
) -> RedirectResponse:
    """A session is only a check, or a calibration after all."""
    set_check(reception.storage, deriving(reception, now), id, Step(by, now, why), is_check=is_check)
    reception.ring()
    return RedirectResponse(f"/sessions/{id}#stage", SEE_OTHER)


@router.post("/sessions/{id}/correct")
def correct(id: Key, by: By, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A corrected file is made of a questioned session's and stands for it."""
    return RedirectResponse(f"/sessions/{correct_session(reception, id, by, now).id}", SEE_OTHER)


@router.post("/sessions/{id}/stand")
def stand(
    id: Key, session: Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)], by: By, why: Why,
    reception: ReceptionOf, now: Now,
) -> RedirectResponse:  # fmt: skip
    """A session stands for another one of the same moment."""
    supersede_session(reception.storage, deriving(reception, now), Replaced(session, by, why), id)
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/sessions/{id}/reference")
def choose(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session is chosen as the reference of its epoch."""
    choose_reference(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/services/{id}/withdraw")
def withdraw_break(id: Number, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A service is taken back."""
    service, _ = withdraw_service(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/units/{quote(service.unit)}#events", SEE_OTHER)
