"""Documents of histories are read as they were written, also those from before tails were stored."""

import numpy as np
import pytest

from estimator.health.error_laws import FREEDOMS
from estimator.health.pooled import Evidence
from service.outlook.store import EARLIEST, SHAPE, WARM, packed, unpacked

RNG = np.random.default_rng(1)
TOLD = [Evidence(1.5 + i, -RNG.exponential(size=SHAPE), -RNG.exponential(size=len(FREEDOMS))) for i in range(17)]


def test_histories_are_read_as_they_were_written() -> None:
    for one, read in zip(TOLD, unpacked(packed(TOLD)), strict=True):
        assert read.span == pytest.approx(one.span)
        assert read.log_tails == pytest.approx(one.log_tails, abs=1e-5)
        assert read.log_evidence == pytest.approx(one.log_evidence - one.log_evidence.max(), abs=1e-5)


def test_what_was_written_before_tells_nothing_of_temperature() -> None:
    rows = [np.concatenate([[one.span], one.log_tails, one.log_evidence[:, :-WARM].ravel()]) for one in TOLD]
    read = unpacked(np.full(1, np.inf, dtype="<f4").tobytes() + np.asarray(rows, dtype="<f4").tobytes())
    assert read[3].log_evidence[:, :-WARM] == pytest.approx(TOLD[3].log_evidence[:, :-WARM])
    assert (read[3].log_evidence[:, -WARM:] == read[3].log_evidence[:, :1]).all()


def test_what_was_written_before_leaves_open_whether_aging_ends() -> None:
    rows = [np.concatenate([[one.span], one.log_tails, one.log_evidence[:, :EARLIEST].ravel()]) for one in TOLD]
    read = unpacked(np.full(1, np.nan, dtype="<f4").tobytes() + np.asarray(rows, dtype="<f4").tobytes())
    assert read[3].log_tails == pytest.approx(TOLD[3].log_tails)
    assert read[3].log_evidence[:, :EARLIEST] == pytest.approx(TOLD[3].log_evidence[:, :EARLIEST])
    assert np.array_equal(read[3].log_evidence[:, EARLIEST:-WARM], read[3].log_evidence[:, EARLIEST - 2 : EARLIEST])


def test_what_was_written_before_tells_nothing_of_tails() -> None:
    rows = [np.append(one.span, one.log_evidence[:, :EARLIEST]) for one in TOLD]
    read = unpacked(np.asarray(rows, dtype="<f4").tobytes())
    assert [one.span for one in read] == pytest.approx([one.span for one in TOLD])
    assert not np.any([one.log_tails for one in read])


def test_no_history_is_none() -> None:
    assert unpacked(packed([])) == ()
