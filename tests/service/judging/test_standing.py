"""The verdict is taken under the alternatives of the strongest finding, and under no model that cannot be."""

from dataclasses import replace
from functools import cache

from estimator.diagnosis import Diagnosis, diagnose
from estimator.reading import read_session
from estimator.session import CalibrationSession
from service.diagnosis.words.causes import UNKNOWN_CAUSE
from service.ingest.checked import as_checked
from service.judging.reservations import MOST_ALTERNATIVES, Basis, verdicts_under_alternatives
from service.sessions.decision import Verdict
from service.types.rules import type_of
from tests.service.diagnosed import ALIASES, drawn
from tests.service.pages.records import NOON


@cache
def case() -> tuple[CalibrationSession, Diagnosis, Basis]:
    """A session whose A2 bends with the cube of the input, or, less likely, with its square."""
    session = read_session(drawn(ALIASES).session)
    found = diagnose(session)
    unit_type = type_of(as_checked(session, NOON, session.unit))
    return session, found, Basis(found.calibration, unit_type, 2.0)


def causes_tried(**changes: object) -> list[tuple[str, ...]]:
    """The models of the verdicts, the strongest finding changed."""
    session, found, basis = case()
    first = replace(found.findings[0], **changes)
    return [one.causes for one in verdicts_under_alternatives(session, (first,), basis)]


def test_every_alternative_stands_in_the_place_of_the_name() -> None:
    assert causes_tried() == [("odd-quadratic",)]


def test_where_none_of_the_known_causes_may_act_the_verdict_is_taken_without_it() -> None:
    assert causes_tried(alternatives=(UNKNOWN_CAUSE,)) == [()]


def test_a_bounded_number_is_tried() -> None:
    many = ("odd-quadratic", "bias-asymmetry", "scale-asymmetry", "hysteresis", "bias-jump")
    assert causes_tried(alternatives=many) == [(name,) for name in many[:MOST_ALTERNATIVES]]


def test_a_wrong_record_has_no_other_model() -> None:
    assert causes_tried(cause="sign-reversed") == []


def test_what_lies_between_sessions_changes_no_model_of_this_one() -> None:
    assert causes_tried(alternatives=("sensor-drift",)) == []


def test_the_verdict_is_that_of_the_rule() -> None:
    session, found, basis = case()
    strict = replace(basis.unit_type.tolerances, scale=1e-15, bias=1e-15, quadratic=None, axis=None)
    impossible = replace(basis, unit_type=replace(basis.unit_type, tolerances=strict))
    [other] = verdicts_under_alternatives(session, found.findings, impossible)
    assert other.verdict is Verdict.UNDECIDABLE
