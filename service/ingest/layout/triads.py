"""Columns that headings name as sensors, and what their values say of it → the sensors of a table.

The three axes of a device share the other words of their headings. At rest, three accelerometers feel gravity; a triad
without it is no triad of accelerometers, whatever its heading says: phones write accelerations freed from gravity.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.layout.evidence import (
    GRAVITIES,
    Array,
    at_rest,
    gravity_at_rest,
    gravity_unit,
    is_like_gravity,
    turns_of,
)
from service.ingest.layout.senses import Sense, sense_of
from service.ingest.layout.vocabulary import LETTERS, conversion, unit_of

AXES = 3
SAME = 0.999
"""Correlation of the axes of two triads from which they are one, written twice: raw and calibrated, say."""
FREED_WORDS = ("lin", "user", "dyn")
"""Beginnings of words for accelerations without gravity, where values do not show it."""
FREED = 0.5
"""Share of gravity below which the usual length of a triad is without it."""


@dataclass(frozen=True)
class SensorTriad:
    """Sensors of one device by the places of their columns."""

    kind: str | None
    senses: Mapping[int, Sense]
    unit: str = ""
    """Unit by the headings, or else by gravity."""

    @property
    def places(self) -> tuple[int, ...]:
        """Places of its columns."""
        return tuple(self.senses)


@dataclass(frozen=True)
class FoundSensor:
    """A column that is a sensor."""

    name: str
    kind: str
    unit: str


Key = TypeVar("Key")


def values_of(columns: Mapping[Key, Array | None], places: Sequence[Key]) -> Array | None:
    """(n, k) values of some columns; None unless all of them have any."""
    cells = [cells for k in places if (cells := columns.get(k)) is not None and len(cells)]
    return np.column_stack(cells) if cells and len(cells) == len(places) else None


def found_in(
    senses: Mapping[int, Sense], values: Mapping[int, Array | None], table: str
) -> dict[int, FoundSensor | None]:
    """Sensors by place; None of what is called one and is none. ``table``: what the table is called."""
    groups: dict[tuple[str | None, tuple[str, ...], str], dict[int, Sense]] = {}
    for k, sense in senses.items():
        groups.setdefault((sense.kind, sense.group if sense.place else (), sense.unit), {})[k] = sense
    triads = [_with_facts(SensorTriad(kind, group, unit), values, table) for (kind, _, unit), group in groups.items()]
    felt = next(
        (values_of(values, t.places) for t in triads if t.kind == ACCELEROMETER and len(t.senses) == AXES), None
    )
    triads = [SensorTriad(GYROSCOPE, t.senses, t.unit) if _reads_turns(t, felt, values) else t for t in triads]
    found: dict[int, FoundSensor | None] = dict.fromkeys(senses)
    for kind in LETTERS:
        for number, triad in enumerate(_apart([t for t in triads if t.kind == kind], values), start=1):
            first = min((sense.place for sense in triad.senses.values()), default="")
            for order, (k, sense) in enumerate(triad.senses.items(), start=1):
                place = str(int(sense.place) + 1) if first == "0" else sense.place or str(order)
                found[k] = FoundSensor(f"{LETTERS[kind]}{number if number > 1 else ''}{place}", kind, triad.unit)
    return found


def without_headings(values: Mapping[int, Array | None]) -> dict[int, FoundSensor | None]:
    """Three columns that feel gravity, and three that read its turns."""
    triples = [range(k, k + AXES) for k in values if all(k + i in values for i in range(AXES))]
    readings = {triple: triad for triple in triples if (triad := values_of(values, triple)) is not None}
    felt = [triple for triple, triad in readings.items() if gravity_unit(gravity_at_rest(triad))]
    if not felt:
        return {}
    steadiest = min(felt, key=lambda triple: at_rest(readings[triple])[1])
    unit = gravity_unit(gravity_at_rest(readings[steadiest]))
    found: dict[int, FoundSensor | None] = {
        k: FoundSensor(f"A{'XYZ'[i]}", ACCELEROMETER, unit) for i, k in enumerate(steadiest)
    }
    explained = {
        turned: turns.explained
        for turned, rates in readings.items()
        if not set(turned) & set(steadiest) and (turns := turns_of(readings[steadiest], rates)) is not None
    }
    best = max(explained, key=lambda turned: explained[turned], default=range(0))
    return found | {k: FoundSensor(f"G{'XYZ'[i]}", GYROSCOPE, "") for i, k in enumerate(best)}


def _with_facts(triad: SensorTriad, values: Mapping[int, Array | None], table: str) -> SensorTriad:
    """The triad with its kind and unit, as far as its values show them; without a kind where it is none."""
    readings = values_of(values, triad.places)
    if triad.kind is None:
        felt = None if readings is None or len(triad.senses) != AXES else gravity_unit(gravity_at_rest(readings))
        by_table = sense_of(table, "")
        kind = ACCELEROMETER if felt else by_table.kind if by_table else None
        triad = SensorTriad(kind, triad.senses, triad.unit)
    if triad.kind != ACCELEROMETER or readings is None or len(triad.senses) != AXES:
        return triad
    measure = unit_of(triad.unit)
    if measure is None:
        whole = bool(np.all(readings == np.round(readings)))
        length = gravity_at_rest(readings)
        words = next(iter(triad.senses.values())).group
        if length is None and any(word.startswith(FREED_WORDS) for word in words):
            return SensorTriad(None, triad.senses)
        return SensorTriad(triad.kind, triad.senses, gravity_unit(length) or ("count" if whole and length else ""))
    if measure.quantity != "acceleration":
        return triad
    times, over, _ = conversion(triad.unit, "g") or (1.0, 1.0, 0.0)
    usual = float(np.nanmedian(np.linalg.norm(readings, axis=1))) * times / over
    length = gravity_at_rest(readings)
    if usual < FREED and not gravity_unit(length):
        return SensorTriad(None, triad.senses, triad.unit)
    is_right = length is None or is_like_gravity(length * times / over, GRAVITIES["g"])
    return triad if is_right else SensorTriad(triad.kind, triad.senses)


def _reads_turns(triad: SensorTriad, felt: Array | None, values: Mapping[int, Array | None]) -> bool:
    """Whether a triad of no kind reads how gravity turns."""
    turned = values_of(values, triad.places)
    is_open = triad.kind is None and len(triad.senses) == AXES
    return is_open and felt is not None and turned is not None and turns_of(felt, turned) is not None


def _apart(triads: Sequence[SensorTriad], values: Mapping[int, Array | None]) -> list[SensorTriad]:
    """Triads of one kind without those that repeat another, or that name no axis beside others that do."""
    with_axes = [triad for triad in triads if all(sense.place for sense in triad.senses.values())] or triads
    kept: list[SensorTriad] = []
    for triad in sorted(with_axes, key=lambda triad: _rank(triad.unit)):
        if not any(_is_same(triad, other, values) for other in kept):
            kept.append(triad)
    return sorted(kept, key=lambda triad: triad.places)


def _rank(unit: str) -> int:
    """A unit of acceleration or rate first."""
    quantity = getattr(unit_of(unit), "quantity", "")
    return 0 if quantity in ("acceleration", "rate") else 1 if quantity else 2


def _is_same(triad: SensorTriad, other: SensorTriad, values: Mapping[int, Array | None]) -> bool:
    mine, others = values_of(values, triad.places), values_of(values, other.places)
    if mine is None or others is None or mine.shape != others.shape or len(mine) < AXES:
        return False
    sound = np.isfinite(mine + others).all(axis=1)
    mine, others = (readings[sound] - readings[sound].mean(axis=0) for readings in (mine, others))
    length = np.sqrt((mine**2).sum(axis=0) * (others**2).sum(axis=0))
    return bool(np.all(length > 0) and np.all(np.abs((mine * others).sum(axis=0)) >= SAME * length))
