"""Documents as this and earlier versions wrote them are read, and written again as they were."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from estimator.allan.results import BlockNoise
from estimator.codec import Document
from estimator.groups import SessionStatistics
from estimator.parity import ParityResult
from estimator.results import Calibration
from service.diagnosis.store import read_diagnosis
from service.groups.store import read_group
from service.models.store import evidence_from_dict, evidence_to_dict
from service.outlook.store import outlook_from_dicts, outlook_to_dicts
from service.sessions.store import reservations_from_list, reservations_to_list
from service.stands.records import StandCondition
from service.storage.json_text import STORED

GOLDEN = Path(__file__).parents[2] / "golden" / "documents"
"""Written by the version before the codec; *older* ones lack what still earlier versions did not write."""


def again(kind: type[Document]) -> Callable[[Any], Any]:
    return lambda document: kind.from_dict(document).to_dict()


def diagnosis(document: Any) -> Any:
    read = read_diagnosis(json.dumps(document))
    return None if read is None else STORED.written(read)


def group(document: Any) -> Any:
    read = read_group(json.dumps(document))
    assert read.structures == tuple(f"{one['where']} ({one['subject']})" for one in document["structures"])
    return STORED.written(read) | {"structures": document["structures"]}


def outlook(document: Any) -> Any:
    return outlook_to_dicts(outlook_from_dicts(document))[0]


def reservations(document: Any) -> Any:
    return reservations_to_list(reservations_from_list("found", document) or ())


AGAIN: dict[str, Callable[[Any], Any]] = {
    "calibration": again(Calibration),
    "diagnosis": diagnosis,
    "evidence": lambda document: evidence_to_dict(evidence_from_dict(document)),
    "group": group,
    "noise": again(BlockNoise),
    "outlook": outlook,
    "parity": again(ParityResult),
    "reservations": reservations,
    "stand": lambda document: STORED.written(STORED.read(StandCondition, document)),
    "statistics": again(SessionStatistics),
}
SPECIAL = ("outlook-drawn", "diagnosis-inapplicable")


def golden(name: str) -> Any:
    return json.loads((GOLDEN / f"{name}.json").read_text())


def within(less: Any, more: Any, path: str = "") -> None:
    """Asserts that everything an earlier version stated is stated again, number for number."""
    if isinstance(less, dict):
        for key in set(less) & set(more) if not path else less:
            within(less[key], more[key], f"{path}.{key}")
    elif isinstance(less, list):
        assert len(less) == len(more), path
        for place, (one, other) in enumerate(zip(less, more, strict=True)):
            within(one, other, f"{path}[{place}]")
    elif path.endswith((".first", ".since")):  # earlier versions kept them as the file states them
        assert bool(less) == bool(more)
    else:
        assert less == more, path


@pytest.mark.parametrize("name", sorted({file.stem for file in GOLDEN.glob("*.json")} - set(SPECIAL)))
def test_a_document_is_read_and_written_as_it_was(name: str) -> None:
    document = golden(name)
    written = AGAIN[name.split("-")[0]](document)
    within(document, written)
    if "old" not in name:
        within(written, document)


def test_what_is_drawn_of_an_outlook_is_kept_apart() -> None:
    document, drawn = golden("outlook"), golden("outlook-drawn")
    assert outlook_to_dicts(outlook_from_dicts(document, drawn)) == (document, drawn)


def test_a_programme_without_causes_has_none() -> None:
    assert diagnosis(golden("diagnosis-inapplicable")) is None
