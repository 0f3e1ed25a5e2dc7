"""What happened to a unit: services, notes, and how it was found and left."""

from fastapi import APIRouter

from service.languages.catalogue import said_in
from service.pages.unit.report import unit_report
from service.papers.found_and_left import found_and_left
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.changes import record_service
from service.records.dependencies import ReceptionOf
from service.records.event_schemas import FoundAndLeftLine, FoundAndLeftSchema, NewNote, NewServiceSchema, NoteList
from service.records.preview import preview_service
from service.records.unit_changes import add_note
from service.sessions.schemas import DecisionSchema, said_session
from service.units.records import NewService, Note, Service, ServicePreview
from service.units.remarks_store import Notes
from service.units.store import Units
from service.uploads.receive import deriving
from service.web.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.web.fields import Serial
from service.web.problem_document import errors

router = APIRouter(prefix="/units", tags=["units"])


@router.post("/{serial:path}/services", status_code=201, responses=errors(400, 404, 422))
def add_service(serial: Serial, new: NewServiceSchema, reception: ReceptionOf, now: Now, person: PersonOf) -> Service:
    """Record a known break; the first session measured after it is the new reference, whenever it was uploaded."""
    done = NewService(new.kind, new.at or now, new.note, person.signs(new.by), new.sensor)
    k = reception.coverage_factor
    service, _ = record_service(reception.storage, serial, done, now, coverage_factor=k)
    reception.ring()
    return service


@router.post("/{serial:path}/services/preview", responses=errors(400, 404, 422))
def preview(
    serial: Serial, new: NewServiceSchema, reception: ReceptionOf, now: Now, person: PersonOf, language: LanguageOf
) -> ServicePreview:
    """What a service would change: verdicts, the next calibration and flags. Nothing is stored."""
    done = NewService(new.kind, new.at or now, new.note, person.signs(new.by), new.sensor)
    return said_in(preview_service(reception.storage, deriving(reception, now), serial, done), language)


@router.get("/{serial:path}/notes", responses=errors(404, 422))
def read_notes(serial: Serial, store: Reading) -> NoteList:
    """The unit's notes, withdrawn ones too."""
    Units(store).key(serial)
    return NoteList(unit=serial, notes=Notes(store).of_unit(serial))


@router.post("/{serial:path}/notes", status_code=201, responses=errors(400, 404, 422))
def write_note(serial: Serial, new: NewNote, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Keep a remark on the unit's history. It can be withdrawn, never changed."""
    note = add_note(storage, serial, new.text, at=new.at or now, who=person.signs(new.by), now=now)
    return note


@router.get("/{serial:path}/found-and-left", responses=errors(404, 422))
def read_found_and_left(serial: Serial, store: Reading, settings: SettingsOf, now: Now) -> FoundAndLeftSchema:
    """The unit as it was found and as it was left, both against the reference that held when it was found."""
    unit = unit_report(store, serial, now)
    pair = found_and_left(store, unit.unit_type, unit.sessions, settings.coverage_factor)
    if pair is None:
        return FoundAndLeftSchema(reference=None, found=None, left=None, parameters=[])
    lines = [
        FoundAndLeftLine(
            found=DecisionSchema.model_validate(found),
            left=None if left is None else DecisionSchema.model_validate(left),
        )
        for found, left in pair.decisions
    ]
    return FoundAndLeftSchema(
        reference=pair.reference,
        found=said_session(pair.found),
        left=None if pair.left is None else said_session(pair.left),
        parameters=lines,
    )
