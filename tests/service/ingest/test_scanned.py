"""The progress of reading a long file is reported now and then, and no more once the answer follows."""

import pytest

from service.ingest import apart as reading
from service.ingest.apart import ProgressReporter


@pytest.fixture
def reported(monkeypatch: pytest.MonkeyPatch) -> tuple[ProgressReporter, list[tuple[int, int]]]:
    """A reporter that leaves no report out, and its reports."""
    monkeypatch.setattr(reading, "PROGRESS_INTERVAL", 0.0)
    reports: list[tuple[int, int]] = []
    return ProgressReporter(lambda *progress: reports.append(progress)), reports


def test_it_counts_the_passes(reported) -> None:
    reporter, reports = reported
    for done in (40, 100, 40, 100, 40):
        reporter.report(done, 100)
    assert reports == [(40, 0), (100, 0), (40, 1), (100, 1), (40, 2)]


def test_it_is_silent_before_the_answer(reported) -> None:
    reporter, reports = reported
    reporter.stop()
    reporter.report(40, 100)
    assert reports == []


def test_reports_come_at_intervals() -> None:
    reports: list[tuple[int, int]] = []
    reporter = ProgressReporter(lambda *progress: reports.append(progress))
    for done in range(100):
        reporter.report(done, 100)
    assert len(reports) == 1
