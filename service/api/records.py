"""Sessions and services are withdrawn, accepted, superseded; references are chosen. Nothing is erased."""

from fastapi import APIRouter, Request

from service.admission import PersonOf
from service.api.schemas.events import NewCheck
from service.api.schemas.fields import Number, Serial, SessionId
from service.api.schemas.flags import Handling
from service.api.schemas.problem import errors
from service.api.schemas.records import Correcting, DerivationSchema, NewReference, StateList, Superseding
from service.api.schemas.reservations import said
from service.api.schemas.sessions import ReceiptAnswer, SaidSession, said_session
from service.dependencies import Now, Reading, ReceptionOf
from service.errors import ConflictError
from service.flows.accept_session import accept_session
from service.flows.choose_reference import choose_reference
from service.flows.correct_session import correct_session
from service.flows.receive import deriving
from service.flows.set_check import set_check
from service.flows.supersede_session import successor_of, supersede_session
from service.flows.withdraw_service import withdraw_service
from service.flows.withdraw_session import withdraw_session
from service.records.event import Service
from service.records.received import Replaced
from service.records.state import RecordKind, Step

router = APIRouter()
REFUSALS = errors(400, 404, 409, 422)
"""What may come instead of the changed record."""


@router.get("/sessions/{id}/states", responses=errors(404, 422), tags=["sessions"])
def read_states(id: SessionId, store: Reading) -> StateList:
    """What became of a session since it was received: by whom, when and why."""
    session = store.sessions.get(id)
    lines = store.states.of(RecordKind.SESSION, id)
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


@router.put("/sessions/{id}/check", responses=errors(400, 404, 422), tags=["sessions"])
def mark_check(id: SessionId, new: NewCheck, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Say that a session is only a check, or a calibration after all; its unit's dates are worked out again."""
    step = Step(person.signs(new.by), now, new.why)
    session = set_check(reception.storage, deriving(reception, now), id, step, is_check=new.is_check)
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
    by = given.superseded_by or successor_of(reception.storage, id)
    replaced = Replaced(id, person.signs(given.by), given.why)
    session, _ = supersede_session(reception.storage, deriving(reception, now), replaced, by)
    reception.ring()
    return said_session(session)


@router.post("/units/{serial:path}/reference", responses=REFUSALS, tags=["units"])
def choose(serial: Serial, new: NewReference, reception: ReceptionOf, now: Now, person: PersonOf) -> SaidSession:
    """Choose and approve the session that all others of its epoch are judged against."""
    with reception.storage.database.reading() as store:
        owner = store.sessions.get(new.session).unit
    if owner != serial:
        raise ConflictError(f"Session {new.session} is of {owner}, not of {serial}.")
    step = Step(person.signs(new.by), now, new.why)
    session, _ = choose_reference(reception.storage, deriving(reception, now), new.session, step)
    reception.ring()
    return said_session(session)


@router.get("/units/{serial:path}/derivation", responses=errors(404, 422), tags=["units"])
def read_derivation(serial: Serial, store: Reading) -> DerivationSchema:
    """How many sessions of the unit are still to be judged again after a change of its records."""
    counted = store.derivations.counted(store.units.key(serial))
    return DerivationSchema(unit=serial, sessions=len(counted), waiting=store.derivations.waiting_of(serial))


@router.post("/services/{id}/withdraw", responses=REFUSALS, tags=["units"])
def withdraw_break(id: Number, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> Service:
    """Take a service back. It stays on record and is no break any more."""
    step = Step(person.signs(handling.by), now, handling.why)
    service, _ = withdraw_service(reception.storage, deriving(reception, now), id, step)
    reception.ring()
    return service
