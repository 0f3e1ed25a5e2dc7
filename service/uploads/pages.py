"""The upload page: the outcome of each file, or its problems and what to do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from enum import StrEnum

from estimator.errors import Problem
from service.diagnosis.sections import DiagnosisLine, diagnosis_line
from service.errors import RefusedError
from service.jobs.records import Job
from service.jobs.words import ending_of, progress_of
from service.kit.limits import in_force
from service.planning.rules import SoFar, read_so_far, so_far
from service.sessions.doubt import Reservations
from service.sessions.records import DiagnosisSummary, Receipt, StoredSession
from service.sessions.sent import SentFile
from service.sessions.states import RecordState
from service.sessions.words.conditions import QUESTIONED, Condition, condition_of
from service.settings import Settings
from service.storage import Storage
from service.uploads.layout.form import Carried

NO_PROGRAMME = "Its programme needs no positions: nothing can be said of it before it is stored."


class Became(StrEnum):
    """Outcomes of an uploaded file, those that need a person first."""

    FAILED = "failed"
    OPEN = "open"
    """A table that is to be checked, or a large file that is being read."""
    STORED = "stored"
    BEFORE = "before"
    """Stored by an earlier upload."""


@dataclass(frozen=True)
class FileOutcome:
    """One uploaded file: either a receipt or the problems."""

    filename: str
    receipt: Receipt | None = None
    problems: tuple[Problem, ...] = ()
    diagnosis: DiagnosisLine | None = None
    """Diagnosis in one line; None for a refused file."""
    pending: bool = False
    """Whether the diagnosis is being made."""
    is_table: bool = False
    """Whether it is a table of custom layout: not read before its mapping is confirmed."""
    carried: Carried | None = None
    """A table, for the page of its mapping."""
    job: Job | None = None
    progress: str = ""
    so_far: SoFar | None = None
    """Session under way, of which nothing was stored."""

    @property
    def became(self) -> Became:
        """Outcome of the file."""
        if self.receipt is not None:
            return Became.STORED if self.receipt.created else Became.BEFORE
        return (
            Became.OPEN
            if self.is_table or self.so_far is not None or (self.job is not None and self.job.is_open)
            else Became.FAILED
        )

    @property
    def condition(self) -> Condition:
        """Condition of the stored session, or of one under way; a refused file has none."""
        if self.so_far is not None:
            return self.so_far.condition
        if self.receipt is None:
            return condition_of(None)
        if self.receipt.state is RecordState.QUESTIONED:
            return QUESTIONED
        return condition_of(self.receipt.verdict, is_reference=self.receipt.is_reference)

    @property
    def reservations(self) -> Reservations:
        """Reservations of the verdict."""
        if self.receipt is None or self.receipt.state is RecordState.QUESTIONED:
            return ()
        return self.receipt.reservations


@dataclass(frozen=True)
class UploadsPage:
    """Contents of the upload page."""

    outcomes: tuple[FileOutcome, ...]
    limit: str
    """Size limit of files of one upload."""
    log_limit: str
    """Size limit of a raw log that is averaged while it is read."""
    follows: bool
    """Whether cards poll for their diagnosis."""
    unit_types: tuple[str, ...] = ()
    """Types for which a template can be made."""

    @property
    def refused(self) -> int:
        """Number of refused files."""
        return sum(o.receipt is None and not o.is_table and o.job is None and o.so_far is None for o in self.outcomes)

    @property
    def tally(self) -> dict[str, int]:
        """Number of files by outcome."""
        return {became: sum(o.became is became for o in self.outcomes) for became in Became}


def outcomes_of(
    files: Sequence[SentFile],
    results: Sequence[Receipt | RefusedError],
    summary: Callable[[str], DiagnosisSummary | None],
) -> tuple[FileOutcome, ...]:
    """Every file with its outcome; ``summary``: the diagnosis of a session, where available."""
    return tuple(_outcome(file.filename, result, summary) for file, result in zip(files, results, strict=True))


def table_outcome(file: SentFile, carried: Carried) -> FileOutcome:
    """A table of custom layout, for its page."""
    return FileOutcome(file.filename, is_table=True, carried=carried)


def job_outcome(job: Job) -> FileOutcome:
    """A large file in progress, or one without a result."""
    return FileOutcome(job.subject, job=job, progress=progress_of(job) or ending_of(job))


def looked_at(storage: Storage, file: SentFile) -> FileOutcome:
    """A session under way, with what it lacks."""
    try:
        session = read_so_far(file)
    except RefusedError as fault:
        return FileOutcome(file.filename, problems=fault.problems)
    return FileOutcome(file.filename, so_far=so_far(storage, session) or SoFar(condition_of(None), (NO_PROGRAMME,)))


def _outcome(
    filename: str, result: Receipt | RefusedError, summary: Callable[[str], DiagnosisSummary | None]
) -> FileOutcome:
    if isinstance(result, RefusedError):
        return FileOutcome(filename, problems=result.problems)
    diagnosis = summary(result.id)
    return FileOutcome(filename, result, diagnosis=diagnosis_line(diagnosis), pending=diagnosis is None)


def outcome_of(session: StoredSession, diagnosis: DiagnosisSummary | None, remark: str = "") -> FileOutcome:
    """Outcome of a file that was uploaded a while ago."""
    values = {f.name: getattr(session, f.name) for f in fields(Receipt) if f.name not in ("created", "remark")}
    receipt = Receipt(created=True, remark=remark, **values)
    return FileOutcome(session.filename, receipt, (), diagnosis_line(diagnosis), diagnosis is None)


def upload_page(outcomes: Sequence[FileOutcome], settings: Settings, unit_types: Sequence[str] = ()) -> UploadsPage:
    """The page before (no outcomes) or after an upload."""
    follows = settings.diagnosis_workers > 0
    limit, log_limit = _limit(in_force().whole), _limit(in_force().log)
    in_order = sorted(outcomes, key=lambda outcome: list(Became).index(outcome.became))
    return UploadsPage(tuple(in_order), limit, log_limit, follows, tuple(unit_types))


def _limit(size: int) -> str:
    """``64 MiB``, ``2 GiB``."""
    return f"{size / 2**30:.4g} GiB" if size >= 2**30 else f"{size / 2**20:.4g} MiB"
