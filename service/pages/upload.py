"""The upload page: what became of each file, or what is wrong with it and what to do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from estimator.errors import Problem
from service.errors import RefusedError
from service.pages.diagnosis_line import DiagnosisLine, diagnosis_line
from service.records.diagnosis import DiagnosisSummary
from service.records.received import SentFile
from service.records.reservation import Reservations
from service.records.session import Receipt
from service.words.conditions import Condition, condition_of


@dataclass(frozen=True)
class Outcome:
    """One uploaded file: either a receipt or the problems."""

    filename: str
    receipt: Receipt | None = None
    problems: tuple[Problem, ...] = ()
    diagnosis: DiagnosisLine | None = None
    """None of a refused file, and where the diagnosis is made after the answer."""

    @property
    def condition(self) -> Condition:
        """Of the stored session; a refused file has none."""
        if self.receipt is None:
            return condition_of(None)
        return condition_of(self.receipt.verdict, is_reference=self.receipt.is_reference)

    @property
    def reservations(self) -> Reservations:
        """What the verdict is said with."""
        return () if self.receipt is None else self.receipt.reservations


@dataclass(frozen=True)
class UploadPage:
    """Everything the upload page shows."""

    outcomes: tuple[Outcome, ...]
    limit: str

    @property
    def refused(self) -> int:
        """How many files could not be used."""
        return sum(o.receipt is None for o in self.outcomes)


def outcomes_of(
    files: Sequence[SentFile],
    found: Sequence[Receipt | RefusedError],
    summary: Callable[[str], DiagnosisSummary | None],
) -> tuple[Outcome, ...]:
    """Every file with what became of it; ``summary``: the diagnosis of a session, where it is made already."""
    return tuple(_outcome(file.filename, one, summary) for file, one in zip(files, found, strict=True))


def _outcome(filename: str, one: Receipt | RefusedError, summary: Callable[[str], DiagnosisSummary | None]) -> Outcome:
    if isinstance(one, RefusedError):
        return Outcome(filename, problems=one.problems)
    made = summary(one.id)
    return Outcome(filename, one, diagnosis=None if made is None else diagnosis_line(made))


def upload_page(outcomes: Sequence[Outcome], max_bytes: int) -> UploadPage:
    """The page before (no outcomes) or after an upload."""
    return UploadPage(tuple(outcomes), f"{max_bytes / 2**20:g} MiB")
