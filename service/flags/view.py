"""Which flags a visitor asked to see: it stands in the address."""

from collections import Counter
from dataclasses import dataclass

from pydantic import BaseModel

from estimator.errors import Problem
from service.errors import RefusedError
from service.flags.records import NOBODY, Assignee, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.kit.person import Person
from service.people.store import Accounts
from service.storage.queries import Store
from service.web.list_view import Asked, ListView, known_order

ME, OF_NOBODY = "me", "nobody"
"""What may stand in an address instead of a name."""


def assignee_meant(store: Store, asked: str, person: Person) -> Assignee | None:
    """Whose flags an address asks for; None for everybody's. RefusedError where nobody says who "me" is; a name that
    no flag has finds nothing."""
    if not asked:
        return None
    if asked == ME:
        return _me(person)
    known = (one for one in Flags(store).assignees() if asked in (one.login, one.name))
    return NOBODY if asked == OF_NOBODY else next(known, Assignee(asked))


def active_names(store: Store) -> tuple[str, ...]:
    """Whom a flag can be given to; empty where there are no accounts, so that anybody can be named."""
    active = [account for account in Accounts(store).every() if account.is_active]
    often = Counter(account.name for account in active)
    return tuple(one.name if one.name and often[one.name] == 1 else one.login for one in active)


def _me(person: Person) -> Assignee:
    if not person.login:
        fault = "`me` is whoever signs in, and nobody did; give a name"
        raise RefusedError("It is not known whose flags are meant.", (Problem("assigned", fault),))
    return Assignee(person.name, person.login)


PAGE_SIZE = 50
"""Flags on a page: as many as anybody ticks one by one."""
STATES = {FlagState.RAISED.value: "Not acknowledged", FlagState.ACKNOWLEDGED.value: "Acknowledged"}
"""Choices, in words."""
NEWEST, OLDEST = "newest", "oldest"
ORDERS = {NEWEST: "newest first", OLDEST: "oldest first"}
MINE, NOBODYS = "Assigned to me", "Assigned to nobody"
NAMES = {
    "text": "q", "matter": "matter", "state": "state", "assigned": "assigned", "sort": "sort", "after": "after",
    "before": "before",
}  # fmt: skip
"""Fields of a view as they are called in an address."""

PLAIN = {"sort": NEWEST}
"""What an address need not say."""
FIRST = {"after": "", "before": ""}
"""What leads to the first page."""


class FlagsAsked(BaseModel):
    """An address as it came."""

    q: Asked = ""
    matter: Asked = ""
    state: Asked = ""
    assigned: Asked = ""
    sort: Asked = ""
    after: Asked = ""
    before: Asked = ""


@dataclass(frozen=True)
class FlagsView(ListView):
    """Flags that are open."""

    PATH = "/flags"
    NAMES = NAMES
    PLAIN = PLAIN
    FIRST = FIRST
    ORDERS = ORDERS
    sort: str = NEWEST
    text: str = ""
    matter: str = ""
    state: str = ""
    assigned: str = ""
    """A name or a login, `me` or `nobody`."""
    after: str = ""
    """The flag that this page follows."""
    before: str = ""
    """The flag that it comes before."""

    @classmethod
    def of(cls, asked: FlagsAsked) -> "FlagsView":
        """The view of an address; what it asks that nobody knows is left out."""
        return cls(
            sort=known_order(asked.sort.removeprefix("-"), ORDERS, NEWEST),
            text=asked.q.strip(),
            matter=asked.matter if asked.matter in set(Matter) else "",
            state=asked.state if asked.state in STATES else "",
            assigned=asked.assigned,
            after=_number(asked.after),
            before="" if _number(asked.after) else _number(asked.before),
        )

    def doing(self, what: str) -> str:
        """Where the form of ticked flags is sent, so that this view comes back."""
        return self.url().replace(self.PATH, f"{self.PATH}/{what}", 1)

    def query(self, assignee: Assignee | None) -> FlagQuery:
        """What the store is asked: one flag more than fit on the page, which says whether there are others."""
        return FlagQuery(
            state=FlagState(self.state) if self.state else None,
            limit=PAGE_SIZE + 1,
            matter=Matter(self.matter) if self.matter else None,
            text=self.text or None,
            unresolved=True,
            assignee=assignee,
            after=int(self.after) if self.after else None,
            before=int(self.before) if self.before else None,
            oldest_first=self.sort == OLDEST,
        )


def choices_of(assignees: tuple[Assignee, ...], *, is_signed_in: bool) -> dict[str, str]:
    """Whose flags can be asked for, in words."""
    own = {ME: MINE} if is_signed_in else {}
    return own | {OF_NOBODY: NOBODYS} | {one.login or one.name: one.name for one in assignees}


def _number(asked: str) -> str:
    """A flag's number; empty where it is none."""
    return asked if asked.isascii() and asked.isdecimal() and 0 < int(asked) <= 2_000_000_000 else ""
