"""Turns by hand that give gyros no scale factors are said beside the verdict; g-sensitivity stands on the page."""

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.hands.world import Truth, World, simulated
from estimator.results import HandTurns, TurnsOutcome
from estimator.session import CalibrationSession
from estimator.writing import session_document
from service.judging.reservations import Doubted, reservations_of
from service.pages.session.pages import session_page
from service.records.diagnose import diagnose
from service.sessions.doubt import DoubtKind
from service.sessions.store import Sessions
from service.storage import Storage
from service.uploads.receive import upload
from tests.builders import Document
from tests.databases import one_engine
from tests.service.judging.test_cause_sizes import BY
from tests.service.pages.records import NOON, session_report

WORLD = World(rests=16, rest=3.0, force=1e-4)


def truth() -> Truth:
    """A log turned by hand, of gyros that answer to force."""
    return simulated(WORLD, np.random.default_rng(5))


def document(session: CalibrationSession) -> Document:
    """The log as a session file."""
    return session_document(replace(session, started_at="2026-03-01T09:00:00Z"))


@pytest.mark.parametrize(
    ("turns", "text"),
    [
        (HandTurns(TurnsOutcome.SCATTERED, 15.2, 1.7), "scatter 15.2 times"),
        (HandTurns(TurnsOutcome.USED, 1.8, 1.0), "scatter 1.8 times"),
        (HandTurns(TurnsOutcome.UNDETERMINED), "do not determine"),
        (HandTurns(TurnsOutcome.AVERAGED), "averaged"),
    ],
)
def test_what_became_of_the_turns_is_a_reservation_with_advice(turns: HandTurns, text: str) -> None:
    by = replace(BY, calibration=replace(BY.calibration, hand_turns=turns))
    (found,) = reservations_of(Doubted(None, (), (), (), by, ()))
    assert found.kind is DoubtKind.HAND_TURNS
    assert text in found.text
    assert found.advice


def test_turns_that_noise_explains_are_none() -> None:
    by = replace(BY, calibration=replace(BY.calibration, hand_turns=HandTurns(TurnsOutcome.USED, 1.0, 1.0)))
    assert reservations_of(Doubted(None, (), (), (), by, ())) == ()


def test_g_sensitivity_stands_in_the_table_of_parameters() -> None:
    page = session_page(session_report(document(truth().session)))
    assert page.parameters[-1] == "g_sensitivity"
    cells = {sensor.name: sensor.cells[-1].value for sensor in page.sensors}
    assert cells["A1"] == ""
    assert cells["G1"].endswith("(°/h)/g")
    assert cells["G1"].count("±") == 3


@one_engine
def test_a_gyro_that_lags_is_said_with_the_verdict(storage: Storage) -> None:
    session = truth().session
    readings = session.readings.copy()
    readings[20:, 4] = readings[:-20, 4]
    content = json.dumps(document(replace(session, readings=readings))).encode()
    id = upload(storage, content, "log.json", NOON).id
    diagnose(storage, id, NOON)
    with storage.database.reading() as store:
        found = Sessions(store).get(id)
    assert DoubtKind.HAND_TURNS in [one.kind for one in found.reservations or ()]
