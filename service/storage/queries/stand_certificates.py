"""Certificates of stands."""

from collections.abc import Sequence
from datetime import date, datetime

from sqlalchemy import select

from service.errors import NotFoundError
from service.records.paper import StandCertificate
from service.storage.paper_tables import StandCertificateRow
from service.storage.queries.base import Queries
from service.storage.tables import StandRow


class StandCertificates(Queries):
    """Certificates by stand; a row is written once."""

    def every(self) -> dict[str, tuple[StandCertificate, ...]]:
        """All stands by name, each with its certificates as they were last recorded, oldest issue first."""
        query = (
            select(StandRow.name, StandCertificateRow)
            .outerjoin(StandCertificateRow, StandCertificateRow.stand_id == StandRow.id)
            .order_by(StandRow.name, StandCertificateRow.id)
        )
        found: dict[str, list[StandCertificate]] = {}
        for name, row in self._session.execute(query):
            own = found.setdefault(name, [])
            if row is not None:
                own.append(_certificate(name, row))
        return {name: _by_issue(own) for name, own in found.items()}

    def of_stand(self, stand: str) -> tuple[StandCertificate, ...]:
        """The certificates of one stand as they were last recorded, oldest issue first."""
        query = (
            select(StandCertificateRow)
            .join(StandRow, StandRow.id == StandCertificateRow.stand_id)
            .where(StandRow.name == stand)
            .order_by(StandCertificateRow.id)
        )
        return _by_issue([_certificate(stand, row) for row in self._session.scalars(query)])

    def known(self, stand: str) -> tuple[StandCertificate, ...]:
        """The same of a stand that must be known."""
        self._key(stand)
        return self.of_stand(stand)

    def on(self, stand: str, day: date) -> StandCertificate | None:
        """The latest certificate of a stand that was issued by a day, whether it still held or not."""
        issued = [certificate for certificate in self.of_stand(stand) if certificate.issued_on <= day]
        return issued[-1] if issued else None

    def add(self, new: StandCertificate, who: str, now: datetime) -> None:
        """Stores a certificate of a stand that is known."""
        values = {**vars(new), "stand_id": self._key(new.stand), "who": who, "recorded_at": now}
        del values["stand"]
        self._session.add(StandCertificateRow(**values))
        self._session.flush()

    def _key(self, stand: str) -> int:
        key = self._session.scalar(select(StandRow.id).where(StandRow.name == stand))
        if key is None:
            raise NotFoundError(f"There is no stand {stand!r}: no session was measured on one of that name.")
        return key


def _by_issue(recorded: Sequence[StandCertificate]) -> tuple[StandCertificate, ...]:
    """Of one number the last that was recorded; of one day of issue the last recorded comes last."""
    last = {certificate.number: place for place, certificate in enumerate(recorded)}
    return tuple(sorted((recorded[place] for place in sorted(last.values())), key=lambda c: c.issued_on))


def _certificate(stand: str, row: StandCertificateRow) -> StandCertificate:
    return StandCertificate(stand, row.number, row.issued_by, row.issued_on, row.valid_until)
