"""Step: a new unit whose file names no type → the type that units of its design have.

A design is what the file describes: kinds of sensor and how many, the unit of their readings, and their nominal scale.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import count

import numpy as np

from service.ingest.checked import Checked
from service.ingest.names import LONGEST_NAME
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.store import UnitTypes
from service.units.store import Units

SAME_DESIGN = 1.2
"""Largest ratio of nominal scales within a design: the next range of a sensor is twice as wide."""


def of_its_design(store: Store, new: Checked) -> Checked:
    """The session with the name of its type; of a unit with a type, or a file that names one, as it is."""
    if new.session.unit_type is not None or Units(store).is_simulated(new.session.unit) is not None:
        return new
    for name in _names(new):
        known = UnitTypes(store).find(name)
        if known is None or not known.block or _is_alike(known, new):
            return replace(new, type_name=name)
    raise AssertionError


def _names(new: Checked) -> Iterator[str]:
    """The description, then with the nominal scale of each kind, then numbered."""
    plain, scales = new.type_name, dict[str, list[float]]()
    yield plain
    for sensor in new.session.sensors:
        scales.setdefault(sensor.kind, []).append(abs(sensor.nominal_scale))
    scaled = ", ".join([plain, *(f"{np.median(of_kind):.4g}" for of_kind in scales.values())])
    yield scaled[:LONGEST_NAME]
    for number in count(2):
        yield f"{scaled[: LONGEST_NAME - 8]} ({number})"


def _is_alike(known: UnitType, new: Checked) -> bool:
    scales = np.abs([sensor.nominal_scale for sensor in new.session.sensors])
    theirs = np.abs(known.nominal_scales)
    if scales.shape != theirs.shape:
        return False
    ratio = np.sort(scales) / np.sort(theirs)
    return bool(np.all((ratio < SAME_DESIGN) & (ratio > 1 / SAME_DESIGN)))
