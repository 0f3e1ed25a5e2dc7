"""Flow: the certificate of a stand's own calibration, on which the numbers of every session on it rest."""

from datetime import datetime

from estimator.errors import problem_at
from service.errors import RefusedError
from service.stands.records import StandCertificate, StandError
from service.stands.store import StandCertificates
from service.storage import Storage
from service.storage.audit import Audit


def record_stand_certificate(
    storage: Storage, new: StandCertificate, now: datetime, *, who: str, errors: tuple[StandError, ...] = ()
) -> StandCertificate:
    """Keeps a certificate; one of a number that is there takes its place, and the same again changes nothing.

    ``errors``: of the stand, as the certificate's document states them.
    """
    if new.valid_until < new.issued_on:
        fault = problem_at(
            "valid_until", "lies before the day of issue, {issued_on}; check both dates", issued_on=new.issued_on
        )
        raise RefusedError("The certificate cannot be used.", (fault,))
    with storage.database.writing() as store:
        kept = StandCertificates(store)
        known = kept.with_errors(new.stand)
        if new not in known or errors not in ((), known[new]):
            kept.add(new, who, now, errors)
            details = {"number": new.number, "valid_until": new.valid_until.isoformat()}
            Audit(store).write(now, who, "stand-certificate", new.stand, details)
    return new
