"""The filter of flags in the address of the list."""

from collections import Counter
from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from estimator.errors import Problem
from service.errors import RefusedError
from service.flags.records import NOBODY, Assignee, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.kit.person import Person
from service.people.store import Accounts
from service.storage.queries import Store
from service.web.fields import Sought
from service.web.list_view import ListView, Words, one_of

ME, OF_NOBODY = "me", "nobody"
"""Values of an address in place of a name."""


def assignee_meant(store: Store, asked: str, person: Person) -> Assignee | None:
    """The assignee in an address; None for all flags. RefusedError where nobody is signed in for "me"; a name that no
    flag has finds nothing.
    """
    if not asked:
        return None
    if asked == ME:
        if not person.login:
            fault = "`me` is whoever signs in, and nobody did; give a name"
            raise RefusedError("It is not known whose flags are meant.", (Problem("assigned", fault),))
        return Assignee(person.name, person.login)
    known = (assignee for assignee in Flags(store).assignees() if asked in (assignee.login, assignee.name))
    return NOBODY if asked == OF_NOBODY else next(known, Assignee(asked))


def active_names(store: Store) -> tuple[str, ...]:
    """Whom a flag can be given to; empty where there are no accounts, so that anybody can be named."""
    active = [account for account in Accounts(store).every() if account.is_active]
    often = Counter(account.name for account in active)
    return tuple(account.name if account.name and often[account.name] == 1 else account.login for account in active)


STATES = {FlagState.RAISED.value: "Not acknowledged", FlagState.ACKNOWLEDGED.value: "Acknowledged"}
"""Choices, in words."""
WORST, NEWEST, OLDEST = "worst", "newest", "oldest"
MINE, NOBODYS = "Assigned to me", "Assigned to nobody"


def _number(asked: str) -> str:
    return asked if asked.isascii() and asked.isdecimal() and 0 < int(asked) <= 2_000_000_000 else ""


def _forward(asked: str) -> str:
    """Each order is named; none is another backwards."""
    return asked.removeprefix("-")


FlagNumber = Annotated[Sought, AfterValidator(_number)]


class FlagsView(ListView):
    """Flags that are open."""

    PATH = "/flags"
    ORDERS: ClassVar = {WORST: "worst first", NEWEST: "newest first", OLDEST: "oldest first"}
    q: Words = ""
    matter: Annotated[Sought, one_of(set(Matter))] = ""
    state: Annotated[Sought, one_of(STATES)] = ""
    assigned: Sought = ""
    """A name or a login, `me` or `nobody`."""
    sort: Annotated[Sought, AfterValidator(_forward), Field(validate_default=True)] = ""
    after: FlagNumber = ""
    before: FlagNumber = ""

    def doing(self, action: str) -> str:
        """The address for the form of ticked flags, from which this view comes back."""
        return self.url().replace(self.PATH, f"{self.PATH}/{action}", 1)

    def query(self, assignee: Assignee | None) -> FlagQuery:
        """The query to the store: one flag more than fit on the page, which tells whether there are others."""
        return FlagQuery(
            state=FlagState(self.state) if self.state else None,
            limit=self.PAGE_SIZE + 1,
            matter=Matter(self.matter) if self.matter else None,
            text=self.q or None,
            unresolved=True,
            assignee=assignee,
            after=int(self.after) if self.after else None,
            before=int(self.before) if self.before else None,
            worst_first=self.sort == WORST,
            backwards=self.sort == OLDEST,
        )


def choices_of(assignees: tuple[Assignee, ...], *, is_signed_in: bool) -> dict[str, str]:
    """Possible assignees to filter by, in words."""
    of_person = {ME: MINE} if is_signed_in else {}
    return of_person | {OF_NOBODY: NOBODYS} | {assignee.login or assignee.name: assignee.name for assignee in assignees}
