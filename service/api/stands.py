"""Stands: their own health, and the certificates of their own calibration."""

from fastapi import APIRouter

from service.admission import PersonOf
from service.api.schemas.fields import StandName
from service.api.schemas.papers import NewStandCertificate, StandCertificateList
from service.api.schemas.problem import errors
from service.api.schemas.stands import StandList
from service.dependencies import Now, Reading, ReadingFleet, StorageOf
from service.flows.record_stand_certificate import record_stand_certificate
from service.records.paper import StandCertificate
from service.views.stands import stand_conditions

router = APIRouter(prefix="/stands", tags=["stands"])


@router.get("", responses=errors())
def list_stands(store: ReadingFleet) -> StandList:
    """Every stand: whether it shifts all units that are measured on it, since when, by how much."""
    return StandList(stands=stand_conditions(store))


@router.get("/{name:path}/certificates", responses=errors(404, 422))
def list_stand_certificates(name: StandName, store: Reading) -> StandCertificateList:
    """The certificates of a stand's own calibration, oldest first; sessions are traceable while one holds."""
    found = store.stand_certificates.known(name)
    return StandCertificateList(certificates=found)


@router.put("/{name:path}/certificate", responses=errors(400, 404, 422))
def put_stand_certificate(
    name: StandName, new: NewStandCertificate, storage: StorageOf, now: Now, person: PersonOf
) -> StandCertificate:
    """Record the certificate of a stand's own calibration; a session is judged by the one of its day."""
    given = StandCertificate(name, new.number, new.issued_by, new.issued_on, new.valid_until)
    return record_stand_certificate(storage, given, now, who=person.signs(new.by))
