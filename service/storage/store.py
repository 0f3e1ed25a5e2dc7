"""The stored fleet as one transaction sees it: `Database` hands out a store and commits it."""

from collections.abc import Callable

from sqlalchemy.orm import Session


class Store:
    """One transaction. Every subject has its queries, made of a store: ``Units(store).find(serial)``."""

    def __init__(self, session: Session, account: str = "") -> None:
        self.session, self.account = session, account


BeforeCommit = Callable[[Store], None]
"""What a transaction that writes does last."""
