"""The pages of flags and their forms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import Field

from estimator.message import say, uncapitalised
from service.flags.changes import Assignment, acknowledge_flag, assign_flag, assign_flags, bring_flags, resolve_flag
from service.flags.records import Flag, FlagState, Matter, Notice, NoticeKind
from service.flags.store import Flags
from service.flags.view import ME, FlagsView, active_names, assignee_meant, choices_of
from service.flags.view import STATES as CHOICES
from service.groups.words import place_in_words
from service.models.records import Scope
from service.pages.waiting import WaitingMatter, waiting_for
from service.people.admission import PersonOf
from service.people.dependencies import SEE_OTHER, By, FormLines, FormText, Number, StorageOf, Why
from service.queue.store import PendingWork
from service.queue.words import pending_in_words
from service.sessions.words.conditions import FIT, NOT_JUDGED, UNDECIDED, UNFIT, Condition
from service.web.dependencies import Now, Reading
from service.web.list_view import Shown
from service.web.render import render

MATTERS = {
    Matter.TOLERANCE: "Out of tolerance",
    Matter.CAUSE: "Cause found",
    Matter.UNEXPLAINED: "Unexplained",
    Matter.STAND: "Stand at fault",
    Matter.SHIFTED: "Stand has shifted",
    Matter.JUMP: "Has jumped",
    Matter.DRIFT: "Drifting",
    Matter.LASTING: "Sessions together",
    Matter.OVERDUE: "Calibration overdue",
}
HOMES = {Scope.UNIT: "units", Scope.UNIT_TYPE: "unit-types", Scope.STAND: "stands"}
STATES = {FlagState.RAISED: "open", FlagState.ACKNOWLEDGED: "acknowledged", FlagState.RESOLVED: "resolved"}
DONE = {
    NoticeKind.RAISED: "raised",
    NoticeKind.SEEN: "seen again",
    NoticeKind.CLEAR: "no longer seen",
    NoticeKind.ACKNOWLEDGED: "acknowledged",
    NoticeKind.ASSIGNED: "assigned",
    NoticeKind.RESOLVED: "resolved",
    NoticeKind.VERDICT: "verdict changed",
}
TONES: dict[FlagState, Condition] = {
    FlagState.RAISED: UNFIT, FlagState.ACKNOWLEDGED: UNDECIDED, FlagState.RESOLVED: FIT,
}  # fmt: skip


@dataclass(frozen=True)
class FlagCard:
    """One flag."""

    flag: Flag
    heading: str
    """``A3 out of tolerance``."""
    state: str
    tone: str
    """Name of the style and the icon."""
    life: tuple[tuple[Notice, str], ...]
    """Events with their word, newest first."""

    @property
    def stand(self) -> str:
        """The stand that it finds at fault; empty where it is about something else."""
        return self.flag.place if self.flag.matter in (Matter.STAND, Matter.SHIFTED) else ""

    @property
    def home(self) -> str:
        """The page of the unit, the type or the stand that it is about."""
        return f"/{HOMES[self.flag.scope]}/{quote(self.name)}"

    @property
    def name(self) -> str:
        """Name of the unit, the type or the stand that it is about."""
        return self.flag.subject or self.flag.unit

    @property
    def is_open(self) -> bool:
        """Whether somebody has yet to act."""
        return self.flag.state is not FlagState.RESOLVED

    @property
    def is_raised(self) -> bool:
        """Whether nobody has acknowledged it."""
        return self.flag.state is FlagState.RAISED


@dataclass(frozen=True)
class FlagsPage:
    """Everything the page of all open flags shows."""

    view: FlagsView
    shown: Shown[Flag]
    cards: tuple[FlagCard, ...]
    matters: Mapping[str, str]
    states: Mapping[str, str]
    """Possible filters of the list, in words."""
    assigned: Mapping[str, str]
    """Assignees to filter by: value in the address, and the name or words."""
    people: tuple[str, ...]
    """Whom a flag can be given to; empty where anybody may be named."""
    pending: str
    """Work in progress that may change the list, in words; empty where there is none."""
    waiting: tuple[WaitingMatter, ...]
    """Matters beside flags that wait for the reader; on the first page of the whole list only."""


def flags_page(
    found: Sequence[Flag],
    view: FlagsView,
    assigned: Mapping[str, str],
    people: Sequence[str],
    pending: str = "",
    waiting: Sequence[WaitingMatter] = (),
) -> FlagsPage:
    """One page of open flags."""
    shown = Shown.of(view, found, lambda flag: flag.id)
    return FlagsPage(
        view=view,
        shown=shown,
        cards=flag_cards(shown.entries),
        matters={matter.value: word for matter, word in MATTERS.items()},
        states=CHOICES,
        assigned=assigned,
        people=tuple(people),
        pending=pending,
        waiting=tuple(waiting),
    )


def flag_cards(flags: Sequence[Flag]) -> tuple[FlagCard, ...]:
    """Cards in the order of the flags."""
    return tuple(
        FlagCard(
            flag=flag,
            heading=_heading(flag),
            state=STATES[flag.state],
            tone=TONES.get(flag.state, NOT_JUDGED).key,
            life=tuple((change, DONE[change.kind]) for change in reversed(flag.changes)),
        )
        for flag in flags
    )


def _heading(flag: Flag) -> str:
    matter = MATTERS[flag.matter]
    if not flag.place:
        return matter
    place = place_in_words(flag.place, flag.subject or flag.unit) if flag.matter is Matter.LASTING else flag.place
    return say("{place}: {matter}", place=place, matter=uncapitalised(matter))


router = APIRouter(prefix="/flags", include_in_schema=False)
Chosen = Annotated[list[Annotated[int, Field(ge=1, le=2_000_000_000)]], Form(min_length=1, max_length=200)]
"""Flags that were ticked."""
Asking = Annotated[FlagsView, Query()]
"""The view that a form was sent from, and that comes back."""
To = FormText
"""Login or name; empty for nobody."""


@router.get("")
def show_flags(request: Request, store: Reading, person: PersonOf, now: Now, view: Asking) -> HTMLResponse:
    """Shows the open flags of the fleet, worst first, or those that the address asks for, after what else waits."""
    if view.assigned == ME and not person.login:
        view = view.model_copy(update={"assigned": ""})
    found = Flags(store).page(view.query(assignee_meant(store, view.assigned, person)))
    assigned = choices_of(Flags(store).assignees(), is_signed_in=bool(person.login))
    pending = pending_in_words(PendingWork(store).counts())
    waiting = () if view.narrows or view.after or view.before else waiting_for(store, person, now)
    return render(request, "flags.html", flags_page(found, view, assigned, active_names(store), pending, waiting))


@router.post("/assign")
def assign_chosen(
    flag: Chosen, by: By, storage: StorageOf, now: Now, *, to: To = "", why: FormLines = "", view: Asking
) -> RedirectResponse:
    """Several are given to somebody."""
    assign_flags(storage, flag, Assignment(to, by, why), now)
    return RedirectResponse(view.url(), SEE_OTHER)


@router.post("/{id}/assign")
def assign(id: Number, by: By, storage: StorageOf, now: Now, *, to: To = "", why: FormLines = "") -> RedirectResponse:
    """One is given to somebody."""
    return _back(assign_flag(storage, id, Assignment(to, by, why), now))


@router.post("/acknowledge")
def acknowledge_chosen(
    flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, to: To = "", view: Asking
) -> RedirectResponse:
    """Acknowledges several flags; assigns them where the form names a person."""
    if to.strip():
        assign_flags(storage, flag, Assignment(to, by), now)
    bring_flags(storage, flag, FlagState.ACKNOWLEDGED, by, why, now)
    return RedirectResponse(view.url(), SEE_OTHER)


@router.post("/resolve")
def resolve_chosen(flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, view: Asking) -> RedirectResponse:
    """Several matters are settled."""
    bring_flags(storage, flag, FlagState.RESOLVED, by, why, now)
    return RedirectResponse(view.url(), SEE_OTHER)


@router.post("/{id}/acknowledge")
def acknowledge(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """Acknowledges the flag."""
    return _back(acknowledge_flag(storage, id, by, why, now))


@router.post("/{id}/resolve")
def resolve(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """The matter is settled."""
    return _back(resolve_flag(storage, id, by, why, now))


def _back(flag: Flag) -> RedirectResponse:
    (card,) = flag_cards([flag])
    return RedirectResponse(f"{card.home}#flags", SEE_OTHER)
