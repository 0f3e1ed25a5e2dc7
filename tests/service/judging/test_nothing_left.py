"""A session whose parameters take all that its readings tell is not called sound."""

import numpy as np

from benchmarks.study.degrees_of_freedom import measured
from estimator import diagnose
from service.diagnosis.records import state_of
from service.diagnosis.words.diagnosis import headline, summary_of, what_to_do
from service.sessions.records import DiagnosisState


def test_where_nothing_is_left_to_judge_by_nothing_is_called_right() -> None:
    """Nine orientations of three accelerometers, no errors stated: nine readings for nine parameters."""
    session, _ = measured(3, 9, False, np.random.default_rng(5))
    found = diagnose(session)
    assert state_of(found) is DiagnosisState.UNDECIDED
    assert headline(found) == "Too few positions for a diagnosis"
    assert summary_of(found).startswith("Too few positions")
    assert "add 5" in what_to_do(found)
