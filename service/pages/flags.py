"""Flags as people read them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from urllib.parse import quote

from service.pages.flags_view import ORDERS, PAGE_SIZE, FlagsView
from service.pages.flags_view import STATES as CHOICES
from service.pages.saved import Saved
from service.records.flag import Flag, FlagState, Matter, Notice, NoticeKind
from service.records.model import Scope
from service.words.conditions import FIT, NOT_JUDGED, UNDECIDED, UNFIT, Condition

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
    """What happened and the word for it, newest first."""

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
        """Of the unit, the type or the stand that it is about."""
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

    cards: tuple[FlagCard, ...]
    earlier: str
    """Address of the page before this one; empty where it is the first."""
    later: str
    """Address of the next page; empty where it is the last."""
    view: FlagsView
    matters: Mapping[str, str]
    states: Mapping[str, str]
    """What the list can be narrowed to, in words."""
    orders: Mapping[str, str]
    assigned: Mapping[str, str]
    """Whose flags can be asked for: what stands in the address, and the name or words."""
    people: tuple[str, ...]
    """Whom a flag can be given to; empty where anybody may be named."""
    saved: Saved
    """Views of the list that were kept."""


def flags_page(
    found: Sequence[Flag], view: FlagsView, assigned: Mapping[str, str], people: Sequence[str], kept: Saved
) -> FlagsPage:
    """One page of open flags; one more than fit on it says that there are others in the direction of reading."""
    backwards, others = bool(view.before), len(found) > PAGE_SIZE
    shown = found[-PAGE_SIZE:] if backwards else found[:PAGE_SIZE]
    is_first, is_last = (not others, False) if backwards else (not view.after, not others)
    return FlagsPage(
        cards=flag_cards(shown),
        earlier="" if is_first or not shown else view.url(before=shown[0].id, after=""),
        later="" if is_last or not shown else view.url(after=shown[-1].id, before=""),
        view=view,
        matters={matter.value: word for matter, word in MATTERS.items()},
        states=CHOICES,
        orders=ORDERS,
        assigned=assigned,
        people=tuple(people),
        saved=kept,
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
    return f"{flag.place}: {matter[0].lower()}{matter[1:]}" if flag.place else matter
