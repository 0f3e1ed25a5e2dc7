"""The register of units, over HTTP: entered, moved, retired and put back, as a table in and out."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field

from estimator.json_object import Json
from estimator.message import say
from service.kit.answer import answer
from service.kit.arriving_files import held
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.records.dependencies import RegisterTurn
from service.records.register import Entered, Entering, enter, move_unit
from service.storage.queries import Store
from service.units.records import Custody, CustodyStep, Move, NewEntry, Registered
from service.units.register_file import read_register
from service.units.store import Register
from service.uploads.received import SentOf
from service.web.dependencies import Now, Reading
from service.web.fields import Body, LongText, Moment, Name, Reason, Serial, Text
from service.web.files import BINARY, BY_HEADER, as_table, table_of, wanted_form
from service.web.problem_document import errors

FORMS = {"application/json": "json", "text/csv": "csv"}
COLUMNS = {
    "serial": str, "unit_type": str, "owner": str, "location": str,
    "custodian": str, "note": str, "retired_on": str,
}  # fmt: skip


class NewEntrySchema(
    Body,
    json_schema_extra={
        "example": {"unit_type": "RA-6", "location": "Hangar 2", "custodian": "K. Ito", "by": "M. Sato"}
    },
):
    """Entry of a unit in the register."""

    unit_type: Text | None = Field(None, description="Name of its type; needed of a unit that is not known yet.")
    owner: Text | None = Field(None, description="To whom it belongs; null leaves it as it is.")
    location: Text | None = Field(None, description="Where it is; null leaves it as it is.")
    custodian: Text | None = Field(None, description="Who has it; null leaves it as it is.")
    note: LongText | None = Field(None, description="What is worth knowing; null leaves it as it is.")
    by: Name = Field(description="Who enters it.")


class NewMove(Body, json_schema_extra={"example": {"location": "Hangar 3", "custodian": "M. Sato", "by": "K. Ito"}}):
    """Move of a unit to another place or custodian."""

    location: Text | None = Field(None, description="Where it is from then on; null where it stays.")
    custodian: Text | None = Field(None, description="Who has it from then on; null where that stays.")
    remark: LongText = Field("", description="Why, or what is worth knowing.")
    at: Moment | None = Field(None, description="When; now if not given. Without a zone it is UTC.")
    by: Name = Field(description="Who records it.")


class NewRetirement(Body, json_schema_extra={"example": {"why": "scrapped", "by": "K. Ito"}}):
    """Retirement of a unit, or its return into use."""

    why: Reason = Field(description="Why.")
    at: Moment | None = Field(None, description="Since when; now if not given. Without a zone it is UTC.")
    by: Name = Field(description="Who records it.")


@answer
@dataclass(frozen=True)
class RegisterEntry(Registered):
    """Entry of a unit in the register, with its history."""

    history: tuple[Custody, ...] = ()
    """Locations and custodians, the latest first."""


class RegisterList(BaseModel):
    """All units."""

    units: tuple[Registered, ...] = Field(description="Retired ones too, by serial number.")


router = APIRouter(tags=["register"])


def entry_of(store: Store, serial: str) -> RegisterEntry:
    """One unit with its history."""
    return RegisterEntry(**vars(Register(store).get(serial)), history=Register(store).history(serial))


@router.get("/register", responses={200: {"content": {"text/csv": BINARY}}, **errors(422)}, response_model=RegisterList)
def read_all(
    request: Request,
    store: Reading,
    format: Annotated[
        Literal["json", "csv"] | None,
        Query(description="Form of the answer; without it the header `Accept` chooses, else it is JSON."),
    ] = None,
) -> Response:
    """Every unit with its owner, location and custodian; the CSV can be changed and sent back."""
    found = Register(store).every()
    form = wanted_form(request, format, FORMS)
    if form == "csv":
        return as_table(table_of([_row(unit) for unit in found], COLUMNS), form, "register")
    document = RegisterList(units=found).model_dump_json()
    return Response(document, media_type="application/json", headers=BY_HEADER)


def _row(unit: Registered) -> dict[str, Any]:
    retired = "" if unit.retired_at is None else f"{unit.retired_at:%Y-%m-%d}"
    return vars(unit) | {"serial": unit.unit, "retired_on": retired}


IMPORTED: Json = {
    "requestBody": {
        "required": True,
        "description": "A form with the CSV as `file`, and who imports it as `by`.",
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file", "by"],
                    "properties": {"file": {"type": "string", "format": "binary"}, "by": {"type": "string"}},
                }
            }
        },
    }
}


@router.post("/register", responses=errors(400, 413, 422, 503), openapi_extra=IMPORTED)
def import_all(sent: SentOf, _: RegisterTurn, storage: StorageOf, now: Now) -> Entered:
    """Enter or change the units of a CSV table. Where a row is wrong, every fault is listed and nothing is stored."""
    return import_register(storage, sent, now)


def import_register(storage: StorageOf, sent: SentOf, now: Now) -> Entered:
    """The units of a file that was sent."""
    entries = read_register(held(sent.given.content), sent.given.filename)
    remark = say("imported from {file}", file=sent.given.filename)
    return enter(storage, entries, Entering(sent.who, now, remark))


@router.get("/units/{serial:path}/register", responses=errors(404, 422))
def read_entry(serial: Serial, store: Reading) -> RegisterEntry:
    """The register's entry of the unit: owner, location, custodian, and their history."""
    return entry_of(store, serial)


@router.put("/units/{serial:path}/register", responses=errors(400, 422))
def put_entry(serial: Serial, new: NewEntrySchema, storage: StorageOf, now: Now, person: PersonOf) -> RegisterEntry:
    """Enter the unit, before or after its first session, or change its entry in the register."""
    stated = new.model_dump(exclude={"by"})
    entry = NewEntry(serial, **{name: text if text is None else text.strip() for name, text in stated.items()})
    enter(storage, (entry,), Entering(person.signs(new.by), now))
    with storage.database.reading() as store:
        return entry_of(store, serial)


@router.post("/units/{serial:path}/moves", status_code=201, responses=errors(400, 404, 409, 422))
def record_move(serial: Serial, new: NewMove, storage: StorageOf, now: Now, person: PersonOf) -> Registered:
    """Record where the unit is and who has it."""
    move = Move(new.location, new.custodian, new.remark)
    return move_unit(storage, serial, move, person.signs(new.by), now, at=new.at)


@router.post("/units/{serial:path}/retire", responses=errors(400, 404, 409, 422))
def retire(serial: Serial, new: NewRetirement, storage: StorageOf, now: Now, person: PersonOf) -> Registered:
    """Retire the unit: fleet, due dates and alarms leave it out; its records stay."""
    move = Move(remark=new.why, step=CustodyStep.RETIRED)
    return move_unit(storage, serial, move, person.signs(new.by), now, at=new.at)


@router.post("/units/{serial:path}/return", responses=errors(400, 404, 409, 422))
def put_back(serial: Serial, new: NewRetirement, storage: StorageOf, now: Now, person: PersonOf) -> Registered:
    """Put a retired unit back into use."""
    move = Move(remark=new.why, step=CustodyStep.RETURNED)
    return move_unit(storage, serial, move, person.signs(new.by), now, at=new.at)
