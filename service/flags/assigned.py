"""Whose flags somebody asks for."""

from collections import Counter

from estimator.errors import Problem
from service.errors import RefusedError
from service.flags.records import NOBODY, Assignee
from service.flags.store import Flags
from service.kit.person import Person
from service.people.store import Accounts
from service.storage.store import Store

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
