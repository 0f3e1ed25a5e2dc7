"""Flow: units are entered in the register, move, are retired and put back into use; every step is kept.

A unit may be entered before its first session: its type is then known by name only, and the first session says what it
has. Nothing of a list is stored where anything in it is wrong; a right one is stored in pieces, so that nobody else who
writes waits for the whole.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from estimator.message import say
from service.errors import ConflictError, RefusedError
from service.ingest.checked import CLOCK_LEEWAY
from service.ingest.names import fault_of_name, fault_of_serial
from service.kit.answer import answer
from service.kit.measures import day_of
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.rules import named_only
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry, Registered
from service.units.register_file import named
from service.units.store import Register, Units

PIECE = 25
"""Units that are stored in one transaction: a quarter of a second on a busy machine."""
NOT_STORED = "The register cannot be changed so. Nothing was stored."
STORED_IN_PART = (
    "Somebody changed the register meanwhile: {stored} of {units} units are entered. Mend the rest and send it again."
)
NO_TYPE = "is missing: say the type of a unit that is not known yet"

ACTIONS = {
    CustodyStep.ENTERED: "register",
    CustodyStep.MOVED: "move unit",
    CustodyStep.RETIRED: "retire unit",
    CustodyStep.RETURNED: "return unit",
}
"""Names in the audit trail."""


@dataclass(frozen=True)
class Entering:
    """Person who enters units, time and remark."""

    who: str
    now: datetime
    remark: str = ""


@answer
@dataclass(frozen=True)
class Entered:
    """Result of entering a list of units."""

    new: int
    """Units that were not known before."""
    changed: int
    """Units of which something is different now."""
    unchanged: int
    """Units of which everything was known already."""


def enter(storage: Storage, entries: Sequence[NewEntry], entering: Entering) -> Entered:
    """Enters units, or changes what the register says of them; RefusedError with every problem by its row, then
    nothing is stored.

    Where somebody else makes one of them wrong meanwhile, the pieces before it stay, and the same list sent again
    changes nothing of them.
    """
    rows = sorted(enumerate(entries, 1), key=lambda numbered: numbered[1].serial)
    with storage.database.reading() as store:
        _known(store, rows, NOT_STORED)
    new = changed = 0
    for start in range(0, len(rows), PIECE):
        piece = rows[start : start + PIECE]
        with storage.database.writing() as store:
            known = _known(store, piece, say(STORED_IN_PART, stored=start, units=len(rows)) if start else NOT_STORED)
            _enter_types(store, piece, known, entering.now)
            changed += sum(_enter(store, entry, known.get(entry.serial), entering) for _, entry in piece)
            new += sum(entry.serial not in known for _, entry in piece)
    return Entered(new, changed - new, len(entries) - changed)


def _enter_types(
    store: Store, rows: Sequence[tuple[int, NewEntry]], known: Mapping[str, Registered], now: datetime
) -> None:
    """Adds the types that units get and that are not known yet."""
    names = {
        entry.unit_type for _, entry in rows if entry.unit_type and _has_other_type(entry, known.get(entry.serial))
    }
    for name in sorted(names):
        UnitTypes(store).add_once(named_only(name), now)


def _has_other_type(entry: NewEntry, known: Registered | None) -> bool:
    return bool(entry.unit_type) and (known is None or entry.unit_type != known.unit_type)


def _known(store: Store, rows: Sequence[tuple[int, NewEntry]], refusal: str) -> dict[str, Registered]:
    """The known units of some rows; RefusedError with every problem of theirs."""
    serials = [entry.serial for _, entry in rows]
    known, measured = Register(store).find(serials), Register(store).measured(serials)
    problems = [
        Problem(problem.field, problem.message, row)
        for row, entry in sorted(rows, key=lambda numbered: numbered[0])
        for problem in _problems(entry, known.get(entry.serial), is_measured=entry.serial in measured)
    ]
    if problems:
        raise RefusedError(refusal, named(problems))
    return known


def _problems(entry: NewEntry, known: Registered | None, *, is_measured: bool) -> list[Problem]:
    found = [Problem("serial", fault)] if known is None and (fault := fault_of_serial(entry.serial)) else []
    if entry.unit_type and (fault := fault_of_name(entry.unit_type)):
        found.append(Problem("unit_type", fault))
    if known is None and not entry.unit_type:
        found.append(Problem("unit_type", NO_TYPE))
    elif known is not None and is_measured and entry.unit_type not in (None, "", known.unit_type):
        fault = say(
            "is {type} by its sessions: leave the type out or write that, and change it on the unit's page",
            type=known.unit_type,
        )
        found.append(Problem("unit_type", fault))
    return found


def _enter(store: Store, entry: NewEntry, known: Registered | None, entering: Entering) -> bool:
    if known is not None and known.registered_at is not None and not _differences(entry, known):
        return False
    if entry.unit_type and _has_other_type(entry, known):
        Units(store).add_once(entry.serial, entry.unit_type, simulated=False)
        Units(store).begin(entry.serial, entry.unit_type, simulated=False)
    unit = Units(store).hold(entry.serial)
    Register(store).put(unit, entry, entering.now)
    is_new = known is None or known.registered_at is None
    moved = {name for name in ("location", "custodian") if known and name in _differences(entry, known)}
    if is_new or moved:
        step = CustodyStep.ENTERED if is_new else CustodyStep.MOVED
        move = Move(entry.location, entry.custodian, entering.remark, step)
        Register(store).add(unit, known, move, entering.now, entering.who, entering.now)
    before = {} if known is None else {name: getattr(known, name) for name in _differences(entry, known)}
    stated = {name: value for name, value in vars(entry).items() if value is not None and name != "serial"}
    Audit(store).write(
        entering.now, entering.who, ACTIONS[CustodyStep.ENTERED], entry.serial, {"before": before, "entry": stated}
    )
    return True


def _differences(entry: NewEntry, known: Registered) -> tuple[str, ...]:
    names = ("unit_type", "owner", "location", "custodian", "note")
    asked = {name: getattr(entry, name) for name in names}
    if not entry.unit_type:
        asked["unit_type"] = None
    return tuple(name for name in names if asked[name] is not None and asked[name] != getattr(known, name))


def move_unit(
    storage: Storage, serial: str, move: Move, who: str, now: datetime, *, at: datetime | None = None
) -> Registered:
    """Records where a unit is or who has it, retires it or puts it back into use; ConflictError where that is so
    already."""
    when = at or now
    if when > now + CLOCK_LEEWAY:
        fault = say("is in the future ({at}); record what has been done", at=f"{when:%Y-%m-%d}")
        raise RefusedError(NOT_STORED, (Problem("at", fault),))
    with storage.database.writing() as store:
        unit = Units(store).hold(serial)
        was = Register(store).get(serial)
        _require_change(was, move)
        Register(store).move(unit, move)
        if move.step in (CustodyStep.RETIRED, CustodyStep.RETURNED):
            Register(store).retire(unit, when if move.step is CustodyStep.RETIRED else None)
        Register(store).add(unit, was, move, when, who, now)
        details = {"location": move.location, "custodian": move.custodian, "remark": move.remark}
        Audit(store).write(now, who, ACTIONS[move.step], serial, details | {"at": when.isoformat()})
        return Register(store).get(serial)


def retired_in_words(entry: Registered) -> str:
    """The remark on a session of a retired unit; empty for a unit in use."""
    if entry.retired_at is None:
        return ""
    day = day_of(entry.retired_at)
    return say("{unit} is retired since {day}: fleet, due dates and alarms leave it out.", unit=entry.unit, day=day)


def _require_change(was: Registered, move: Move) -> None:
    if move.step is CustodyStep.RETIRED and was.retired_at is not None:
        day = day_of(was.retired_at)
        raise ConflictError("{unit} is retired since {day} already.", unit=was.unit, day=day)
    if move.step is CustodyStep.RETURNED and was.retired_at is None:
        raise ConflictError("{unit} is in use already.", unit=was.unit)
    asked = {"location": move.location, "custodian": move.custodian}
    is_same = all(value in (None, getattr(was, name)) for name, value in asked.items())
    if move.step is CustodyStep.MOVED and is_same:
        raise ConflictError("{unit} is there already, with the same custodian.", unit=was.unit)
