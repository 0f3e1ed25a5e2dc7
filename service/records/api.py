"""States of records, and events of a unit over HTTP: services, notes, and the unit as found and as left."""

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from service.errors import ConflictError
from service.flags.api import Handling
from service.judging.records import said
from service.judging.store import Derivations
from service.languages.catalogue import said_in
from service.pages.unit.report import unit_report
from service.papers.found_and_left import found_and_left
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.changes import accept_session, choose_reference, record_service, withdraw_service, withdraw_session
from service.records.dependencies import ReceptionOf
from service.records.event_schemas import FoundAndLeftLine, FoundAndLeftSchema, NewNote, NewServiceSchema, NoteList
from service.records.preview import preview_service
from service.records.supersede import successor_of, supersede_session
from service.records.unit_changes import add_note
from service.records.unit_type import set_type
from service.sessions.schemas import DecisionSchema, ReceiptAnswer, SaidSession, said_session
from service.sessions.sent import Replaced
from service.sessions.states import RecordKind, RecordState, StateChange, Step
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.types.records import UnitType
from service.units.records import NewService, Note, Service, ServicePreview
from service.units.remarks_store import Notes
from service.units.store import Units
from service.uploads.correct import correct_session
from service.uploads.receive import deriving
from service.web.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.web.fields import Body, Name, Number, Reason, Serial, SessionId, Text
from service.web.problem_document import errors


class StateList(BaseModel):
    """The life of a session."""

    session: str = Field(description="Its id.")
    state: RecordState = Field(description="What it is now. Only an accepted session counts for its unit.")
    states: tuple[StateChange, ...] = Field(description="Oldest first; empty where it was accepted and remained so.")


class Correcting(Body, json_schema_extra={"example": {"by": "K. Ito"}}):
    """Request to have a questioned session's file corrected."""

    by: Name = Field(description="Who says so.")


class Superseding(
    Body,
    json_schema_extra={"example": {"by": "K. Ito", "why": "alpha mistyped", "superseded_by": "3f9a0c5be1d24786aa10"}},
):
    """Session that supersedes another, with the person and the reason."""

    by: Name = Field(description="Who says so.")
    why: Reason = Field(description="Why; what was wrong.")
    superseded_by: Text | None = Field(
        default=None,
        description="The session that counts from now on. It can be left out where only one was uploaded later of the "
        "same unit, programme and date.",
    )


class NewReference(
    Body,
    json_schema_extra={
        "example": {"session": "3f9a0c5be1d24786aa10", "by": "K. Ito", "why": "the first one was measured warm"}
    },
):
    """The session that an engineer chooses as the reference of its epoch."""

    session: Text = Field(description="Its id; it must be accepted and give an uncertainty.")
    by: Name = Field(description="Who chooses and approves it.")
    why: Reason = Field(description="Why.")


class DerivationSchema(BaseModel):
    """Progress of the judgements of a unit after a change of its records."""

    unit: str = Field(description="Serial number of the unit.")
    sessions: int = Field(description="Its accepted sessions.")
    waiting: int = Field(description="Those that are still to be judged again after a change of its records.")


router = APIRouter()
REFUSALS = errors(400, 404, 409, 422)
"""Answers in place of the changed record."""


@router.get("/sessions/{id}/states", responses=errors(404, 422), tags=["sessions"])
def read_states(id: SessionId, store: Reading) -> StateList:
    """Changes of state of a session since it was received: by whom, when and why."""
    session = Sessions(store).get(id)
    lines = States(store).of(RecordKind.SESSION, id)
    return StateList(session=id, state=session.state, states=lines)


@router.post("/sessions/{id}/withdraw", responses=REFUSALS, tags=["sessions"])
def withdraw(id: SessionId, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Take a session back. It stays readable, and nothing that is known of its unit rests on it any more."""
    step = Step(person.signs(handling.by), now, handling.why)
    session, _ = withdraw_session(reception.storage, deriving(reception, now), id, step)
    reception.ring()
    return said_session(session)


@router.post("/sessions/{id}/accept", responses=REFUSALS, tags=["sessions"])
def accept(id: SessionId, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Say that a session counts that was questioned, withdrawn or superseded."""
    step = Step(person.signs(handling.by), now, handling.why)
    session, _ = accept_session(reception.storage, deriving(reception, now), id, step)
    reception.ring()
    return said_session(session)


@router.post("/sessions/{id}/correct", responses=REFUSALS, tags=["sessions"])
def correct(
    id: SessionId, given: Correcting, request: Request, reception: ReceptionOf, now: Now, person: PersonOf
) -> ReceiptAnswer:
    """Make a corrected file of a questioned session's, with what would put it right, and let it stand for it."""
    receipt = correct_session(reception, id, person.signs(given.by), now)
    url = str(request.url_for("read_session", id=receipt.id))
    return ReceiptAnswer(**said(receipt), url=url)


@router.post("/sessions/{id}/supersede", responses=REFUSALS, tags=["sessions"])
def supersede(id: SessionId, given: Superseding, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Say that another stored session supersedes this one: a corrected file, of another unit or date."""
    successor = given.superseded_by or successor_of(reception.storage, id)
    replaced = Replaced(id, person.signs(given.by), given.why)
    session, _ = supersede_session(reception.storage, deriving(reception, now), replaced, successor)
    reception.ring()
    return said_session(session)


@router.post("/units/{serial:path}/reference", responses=REFUSALS, tags=["units"])
def choose(serial: Serial, new: NewReference, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Choose and approve the session that all others of its epoch are judged against."""
    with reception.storage.database.reading() as store:
        owner = Sessions(store).get(new.session).unit
    if owner != serial:
        raise ConflictError(
            "Session {session} is of {owner}, not of {serial}.", session=new.session, owner=owner, serial=serial
        )
    step = Step(person.signs(new.by), now, new.why)
    session, _ = choose_reference(reception.storage, deriving(reception, now), new.session, step)
    reception.ring()
    return said_session(session)


class NewType(Body, json_schema_extra={"example": {"unit_type": "RA-6", "by": "K. Ito", "why": "the maker's name"}}):
    """Another type of a unit."""

    unit_type: Text = Field(description="Name of the type; a new one where there is none of that name.")
    by: Name = Field(description="Who moves it.")
    why: Reason = Field(description="Why.")


@router.put("/units/{serial:path}/type", responses=REFUSALS, tags=["units"])
def move_to_type(serial: Serial, new: NewType, reception: ReceptionOf, now: Now, person: PersonOf) -> UnitType:
    """Move the unit to another type with as many sensors of the same kinds: its sessions are judged by that one's
    tolerances."""
    step = Step(person.signs(new.by), now, new.why)
    moved = set_type(reception.storage, deriving(reception, now), serial, new.unit_type.strip(), step)
    reception.ring()
    return moved


@router.get("/units/{serial:path}/derivation", responses=errors(404, 422), tags=["units"])
def read_derivation(serial: Serial, store: Reading) -> DerivationSchema:
    """Number of the unit's sessions still to be judged again after a change of its records."""
    counted = Derivations(store).counted(Units(store).key(serial))
    return DerivationSchema(unit=serial, sessions=len(counted), waiting=Derivations(store).waiting_of(serial))


@router.post("/services/{id}/withdraw", responses=REFUSALS, tags=["units"])
def withdraw_break(id: Number, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> Service:
    """Take a service back. It stays on record and is no break any more."""
    step = Step(person.signs(handling.by), now, handling.why)
    service, _ = withdraw_service(reception.storage, deriving(reception, now), id, step)
    reception.ring()
    return service


events_router = APIRouter(prefix="/units", tags=["units"])


@events_router.post("/{serial:path}/services", status_code=201, responses=errors(400, 404, 422))
def add_service(serial: Serial, new: NewServiceSchema, reception: ReceptionOf, now: Now, person: PersonOf) -> Service:
    """Record a known break; the first session measured after it is the new reference, whenever it was uploaded."""
    done = NewService(new.kind, new.at or now, new.note, person.signs(new.by), new.sensor)
    k = reception.coverage_factor
    service, _ = record_service(reception.storage, serial, done, now, coverage_factor=k)
    reception.ring()
    return service


@events_router.post("/{serial:path}/services/preview", responses=errors(400, 404, 422))
def preview(
    serial: Serial, new: NewServiceSchema, reception: ReceptionOf, now: Now, person: PersonOf, language: LanguageOf
) -> ServicePreview:
    """The changes that a service would bring: verdicts, the next calibration and flags. Nothing is stored."""
    done = NewService(new.kind, new.at or now, new.note, person.signs(new.by), new.sensor)
    return said_in(preview_service(reception.storage, deriving(reception, now), serial, done), language)


@events_router.get("/{serial:path}/notes", responses=errors(404, 422))
def read_notes(serial: Serial, store: Reading) -> NoteList:
    """The unit's notes, withdrawn ones too."""
    Units(store).key(serial)
    return NoteList(unit=serial, notes=Notes(store).of_unit(serial))


@events_router.post("/{serial:path}/notes", status_code=201, responses=errors(400, 404, 422))
def write_note(serial: Serial, new: NewNote, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Keep a remark on the unit's history. It can be withdrawn, never changed."""
    note = add_note(storage, serial, new.text, at=new.at or now, who=person.signs(new.by), now=now)
    return note


@events_router.get("/{serial:path}/found-and-left", responses=errors(404, 422))
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
