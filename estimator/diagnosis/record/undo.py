"""Put the record right where it is plainly wrong, before finer causes are sought."""

from collections.abc import Sequence

from estimator.causes.contract import Cause, RecordCorrection
from estimator.diagnosis.record.exchanged_rows import exchanged_rows
from estimator.diagnosis.record.record_error import RecordError
from estimator.diagnosis.record.turned import expected_axes, turned_record
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of

MOST = 3
"""Record errors undone one after another: it bounds the search, for one error may mislead the look for another."""


def undo_record_errors(
    baseline: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]
) -> tuple[list[RecordError], Baseline]:
    """The record errors of the catalogue that were found in a fitted session, and the corrected session, fitted."""
    known = [c for c in catalogue if isinstance(c, RecordCorrection)]
    errors: list[RecordError] = []
    for _ in range(MOST):
        expected = expected_axes(history, baseline.session)
        error = turned_record(baseline, expected, known) or exchanged_rows(baseline, known)
        if error is None:
            break
        errors.append(error)
        baseline = baseline_of(error.undone.session)
    return [e for e in errors if not is_reverted(e, errors)], baseline


def is_reverted(error: RecordError, errors: Sequence[RecordError]) -> bool:
    """Whether a record error was undone and then done again, because another one had misled the first look."""
    undone = error.undone
    same = [e for e in errors if (e.undone.cause, e.undone.places) == (undone.cause, undone.places)]
    return len(same) % 2 == 0
