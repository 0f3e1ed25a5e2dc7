"""Standard errors that are stated wrong, beside a verdict."""

import pytest

from estimator.diagnosis.results import NoiseScale
from service.judging.reservations import Doubted, reservations_of
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind
from tests.service.judging.test_cause_sizes import BY


def kinds(verdict: Verdict | None, factor: float) -> list[DoubtKind]:
    """Reservations of a verdict where errors are ``factor`` times the stated ones."""
    noise = (NoiseScale("accelerometer", factor, 60.0),)
    return [one.kind for one in reservations_of(Doubted(verdict, (), (), noise, BY, ()))]


@pytest.mark.parametrize("verdict", [None, *Verdict])
def test_errors_stated_too_small_qualify_every_verdict(verdict: Verdict | None) -> None:
    assert kinds(verdict, 4.0) == [DoubtKind.STATED_ERRORS]


@pytest.mark.parametrize("verdict", [None, Verdict.PASS, Verdict.FAIL])
def test_errors_stated_too_large_leave_a_plain_verdict_plain(verdict: Verdict | None) -> None:
    assert kinds(verdict, 0.25) == []


@pytest.mark.parametrize("verdict", [Verdict.CONDITIONAL_PASS, Verdict.UNDECIDABLE, Verdict.CONDITIONAL_FAIL])
def test_errors_stated_too_large_qualify_a_verdict_in_doubt(verdict: Verdict) -> None:
    assert kinds(verdict, 0.25) == [DoubtKind.STATED_ERRORS]
