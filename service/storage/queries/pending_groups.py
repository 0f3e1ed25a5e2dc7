"""Groups whose answer is to be made again: asked for, claimed by one process at a time, settled once."""

from collections.abc import Collection, Iterable
from datetime import datetime

from sqlalchemy import ColumnElement, delete, func, insert, or_, select, update

from service.records.group import Group, Level
from service.storage.failed import AT_FAULT
from service.storage.group_tables import AskedRow, PendingGroupRow, PendingSummaryRow
from service.storage.pending_tables import NEVER
from service.storage.queries.base import Queries
from service.storage.queries.groups import Groups


class PendingGroups(Queries):
    """Of groups of which a session has changed."""

    _row: type[AskedRow] = PendingGroupRow

    def ask(self, groups: Iterable[Group], now: datetime) -> None:
        """Asks for what groups show; what is being made of them now is looked at again."""
        asked = tuple(groups)
        rows = [{"level": g.level.value, "group_id": g.key, "asked_at": now, "attempts": 0} for g in asked]
        if rows:
            self._session.execute(insert(self._row), rows)
        for group in asked:
            failed = update(self._row).where(*self._of(group), self._row.failed.is_not(None))
            self._session.execute(failed.values(claimed_until=None, attempts=0))

    def asked(self, group: Group) -> tuple[int, ...]:
        """Who asks for a group now: to be read before its sessions are."""
        return tuple(self._session.scalars(select(self._row.id).where(*self._of(group))))

    def waiting(self, now: datetime, limit: int) -> tuple[Group, ...]:
        """Groups that nobody is at, the one that was asked for first before all."""
        key = (self._row.level, self._row.group_id)
        until = func.max(self._row.claimed_until)
        query = select(*key).group_by(*key).having(or_(until.is_(None), until <= now))
        first = query.order_by(func.min(self._row.asked_at), *key).limit(limit)
        groups = Groups(self._session)
        return tuple(groups.by_key(Level(level), id) for level, id in self._session.execute(first))

    def claim(self, group: Group, now: datetime, until: datetime) -> int | None:
        """How often a group was claimed, with this time, since a claim ended with a word; None where another is at
        it."""
        is_free = or_(self._row.claimed_until.is_(None), self._row.claimed_until <= now)
        own = update(self._row).where(*self._of(group), is_free)
        claimed = own.values(claimed_until=until, attempts=self._row.attempts + 1)
        return max(self._session.scalars(claimed.returning(self._row.attempts)).all(), default=None)

    def extend(self, group: Group, until: datetime) -> None:
        """Whoever claimed it is still at it."""
        self._session.execute(
            update(self._row).where(*self._of(group), self._row.claimed_until.is_not(None)).values(claimed_until=until)
        )

    def give_back(self, group: Group) -> None:
        """Whoever was at it died: the next one may begin at once."""
        self._session.execute(update(self._row).where(*self._of(group)).values(claimed_until=None))

    def put_off(self, group: Group, until: datetime | None) -> None:
        """Gives a group back after a word of why: nobody begins it before a time."""
        self._session.execute(update(self._row).where(*self._of(group)).values(claimed_until=until, attempts=0))

    def hold_up(self, group: Group, why: str) -> None:
        """Keeps why a try failed."""
        self._session.execute(update(self._row).where(*self._of(group)).values(failed=why))

    def failed(self, group: Group) -> str:
        """Why the last try failed; empty where none did."""
        return self._session.scalar(select(func.max(self._row.failed)).where(*self._of(group))) or ""

    def give_up(self, group: Group) -> None:
        """No try succeeded: the next asking tries again, another start, or whoever wants that."""
        why = func.coalesce(self._row.failed, AT_FAULT)
        self._session.execute(update(self._row).where(*self._of(group)).values(claimed_until=NEVER, failed=why))

    def try_again(self) -> int:
        """What failed is tried at once; how many groups that are."""
        own = update(self._row).where(self._row.failed.is_not(None)).values(claimed_until=None, attempts=0, failed=None)
        found = self._session.execute(own.returning(self._row.level, self._row.group_id))
        return len({(level, key) for level, key in found})

    def blame_none(self, group: Group) -> None:
        """What died was at fault for another reason that is known now: the tries are counted anew."""
        self._session.execute(update(self._row).where(*self._of(group)).values(attempts=0))

    def settle(self, asked: Collection[int]) -> None:
        """Who asked has the answer; whoever asked since has not."""
        self._session.execute(delete(self._row).where(self._row.id.in_(tuple(asked))))

    def _of(self, group: Group) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
        return self._row.level == group.level.value, self._row.group_id == group.key


class PendingSummaries(PendingGroups):
    """Unit types of which a unit drifts otherwise, stands on which a unit was measured."""

    _row = PendingSummaryRow

    def any(self) -> bool:
        """Whether any is asked for and was not given up."""
        return self._session.scalar(select(self._row.id).limit(1)) is not None

    def asked_of(self, level: Level) -> tuple[int, ...]:
        """Who asks for any group of a level now."""
        return tuple(self._session.scalars(select(self._row.id).where(self._row.level == level.value)))
