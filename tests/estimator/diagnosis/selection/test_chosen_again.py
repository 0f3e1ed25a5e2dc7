"""Naming may not predict worse than not naming."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.residuals.prediction import FOLDS, fold_of, predicted
from estimator.diagnosis.selection.chosen_again import chosen_in_folds, without_unpredictive
from tests.estimator.diagnosis.selection.small import ROWS, candidate, effect, names, on_sensor, start


@pytest.mark.parametrize("identifier", ["scale-asymmetry", "bias-ramp", "bias-jump", "beta-second-harmonic"])
def test_a_true_cause_predicts_and_stays(identifier: str) -> None:
    state = start((identifier,), effect(identifier))
    place = () if identifier.startswith("beta") else (1,)
    named = replace(state, detections=(candidate(state, identifier, place),))
    assert names(without_unpredictive(named)) == names(named)


def test_a_name_that_predicts_worse_goes() -> None:
    """Noise alone: the jump that happens to fit best fits the rows it was chosen on."""
    state = start(("bias-jump",), 0.0)
    named = replace(state, detections=(candidate(state, "bias-jump"),))
    assert names(without_unpredictive(named)) == []


def test_shapes_are_chosen_again_without_the_rows_held_out() -> None:
    """A row far out leads the choice only where it is not held out."""
    far = on_sensor(np.where(np.arange(ROWS) == 7, 30.0, 0.0))
    state = start(("reading-outlier",), far)
    found = candidate(state, "reading-outlier")
    chosen = chosen_in_folds(state.residuals, state.traces, [found])
    rows = [int(np.abs(columns[0][:, 1, 0]).argmax()) for columns in chosen]
    held = int(fold_of(ROWS)[7])
    assert [row == 7 for row in rows] == [fold != held for fold in range(FOLDS)]


def test_every_row_is_predicted_by_the_others() -> None:
    state = start((), 0.0)
    rows = predicted(state.baseline, [()] * FOLDS)
    assert rows.count == ROWS * 4
    assert rows.square / rows.count == pytest.approx(1, abs=0.35)
