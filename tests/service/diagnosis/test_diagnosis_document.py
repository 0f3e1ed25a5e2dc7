"""A stored diagnosis comes back typed, whichever version wrote it."""

import json
from dataclasses import asdict
from math import isnan
from typing import Any

import pytest

from estimator import diagnose
from estimator.diagnosis.results import Course, NoiseScale, Structure
from estimator.reading import read_session
from service.diagnosis.records import Diagnosed
from service.diagnosis.store import inapplicable_to_dict, read_diagnosis
from service.diagnosis.words.findings import since_together
from service.models.store import evidence_from_dict, evidence_to_dict
from service.storage.json_text import json_text
from tests.service.diagnosed import ALIASES, TEMPERATURE, UNEXPLAINED, drawn
from tests.service.findings import earlier_document


def read(**changes: Any) -> Diagnosed:
    """An earlier document with something changed in its finding."""
    found = read_diagnosis(json.dumps(earlier_document(**changes)))
    assert found is not None
    return found


@pytest.mark.parametrize("what", [TEMPERATURE, ALIASES, UNEXPLAINED])
def test_what_was_found_comes_back(what: tuple[str, tuple[int, ...], str | None]) -> None:
    before = diagnose(read_session(drawn(what).session))
    after = read_diagnosis(json_text(before.to_dict()))
    assert after is not None
    assert (after.findings, after.structures) == (before.findings, before.structures)
    assert (after.gain, after.limits, after.notes) == (before.gain, before.limits, before.notes)
    assert after.calibration.to_dict() == before.calibration.to_dict()
    assert after.residuals_before.to_dict() == before.baseline.residuals.to_dict()


def test_a_mixed_up_record_a_course_and_wrong_standard_errors_come_back() -> None:
    mixed = Structure("mixed up", ("A1",), 0.0, 9.0, of_record=True)
    course = Structure("α", (), 1e-9, 7.0, Course("β", ("α", "size"), ((1e-5, 2e-6), (-1e-5, 3e-6))))
    noise = NoiseScale("accelerometer", 4.0, 70.0, ("A1", "A3"))
    document = earlier_document() | {"structures": [s.to_dict() for s in (mixed, course)], "noise": [asdict(noise)]}
    found = read_diagnosis(json.dumps(document))
    assert found is not None
    assert (found.structures, found.noise) == ((mixed, course), (noise,))


def test_an_earlier_version_gave_one_shape_for_all_sensors() -> None:
    (finding,) = read().findings
    assert finding.nonlinear_each == ({"row": 14.0},)


@pytest.mark.parametrize(("stored", "read_as"), [("", None), ("2026-03-01T01:30:00+03:00", "2026-02-28T22:30:00Z")])
def test_an_earlier_version_kept_moments_as_files_state_them(stored: str, read_as: str | None) -> None:
    together = {"sessions": 9, "e_value": 1e6, "form": "since", "since": stored, "spread": [0.0], "here": 0.99}
    (finding,) = read(over_sessions=together).findings
    assert finding.over_sessions is not None
    assert finding.over_sessions.since == read_as
    assert since_together(finding.over_sessions).startswith("It began ")


def test_an_earlier_version_looked_at_no_session_before() -> None:
    assert read().gain.session is None


def test_a_number_that_was_not_finite_is_no_number_again() -> None:
    (finding,) = read(p_value=None, sigma=[None, 1e-5], amplitude=[None, 2e-4]).findings
    assert (isnan(finding.p_value), isnan(finding.sigma[0]), finding.sigma[1]) == (True, True, 1e-5)


def test_a_programme_without_causes_has_no_diagnosis() -> None:
    assert read_diagnosis(json_text(inapplicable_to_dict("BA-017"))) is None


def test_evidence_of_an_earlier_version_keeps_all_it_states() -> None:
    finding = earlier_document()["findings"][0]
    names = ("p_value", "strength", "amplitude", "sigma", "units", "nonlinear", "alternatives", "sentence")
    stored = {name: finding[name] for name in names} | {"gain": earlier_document()["gain"]}
    again = evidence_to_dict(evidence_from_dict(stored))
    assert {name: again[name] for name in names} == {name: stored[name] for name in names}
    scores = {side: score | {"rms_by_kind": {}} for side, score in stored["gain"].items() if side != "held_out"}
    assert again["gain"] == stored["gain"] | scores | {"session": None}


def test_a_withdrawal_rests_on_no_evidence() -> None:
    assert evidence_from_dict(evidence_to_dict(None)) is None
