"""The upload page: what became of each file, or what is wrong with it and what to do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

from estimator.errors import Problem
from service.diagnosis.sections import DiagnosisLine, diagnosis_line
from service.errors import RefusedError
from service.jobs.records import Job
from service.jobs.words import ending_of, progress_of
from service.kit.limits import in_force
from service.sessions.doubt import Reservations
from service.sessions.records import DiagnosisSummary, Receipt, StoredSession
from service.sessions.sent import SentFile
from service.sessions.states import RecordState
from service.sessions.words.conditions import QUESTIONED, Condition, condition_of
from service.settings import Settings
from service.uploads.layout.form import Carried


@dataclass(frozen=True)
class Outcome:
    """One uploaded file: either a receipt or the problems."""

    filename: str
    receipt: Receipt | None = None
    problems: tuple[Problem, ...] = ()
    diagnosis: DiagnosisLine | None = None
    """None of a refused file."""
    pending: bool = False
    """Whether the diagnosis is still being made."""
    is_table: bool = False
    """Of one's own layout, not read before its page says how."""
    carried: Carried | None = None
    """A table, for the page that asks about it."""
    job: Job | None = None
    """That works on a large file."""
    progress: str = ""
    """How far it is."""

    @property
    def condition(self) -> Condition:
        """Of the stored session; a refused file has none."""
        if self.receipt is None:
            return condition_of(None)
        if self.receipt.state is RecordState.QUESTIONED:
            return QUESTIONED
        return condition_of(self.receipt.verdict, is_reference=self.receipt.is_reference)

    @property
    def reservations(self) -> Reservations:
        """What the verdict is said with."""
        if self.receipt is None or self.receipt.state is RecordState.QUESTIONED:
            return ()
        return self.receipt.reservations


@dataclass(frozen=True)
class UploadPage:
    """Everything the upload page shows."""

    outcomes: tuple[Outcome, ...]
    limit: str
    """Of files at a time."""
    log_limit: str
    """Of a raw log that is averaged while it is read."""
    follows: bool
    """Whether cards look again whether their diagnosis is made."""
    unit_types: tuple[str, ...] = ()
    """That a template can be made for."""

    @property
    def refused(self) -> int:
        """How many files could not be used."""
        return sum(o.receipt is None and not o.is_table and o.job is None for o in self.outcomes)


def outcomes_of(
    files: Sequence[SentFile],
    found: Sequence[Receipt | RefusedError],
    summary: Callable[[str], DiagnosisSummary | None],
) -> tuple[Outcome, ...]:
    """Every file with what became of it; ``summary``: the diagnosis of a session, where it is made already."""
    return tuple(_outcome(file.filename, one, summary) for file, one in zip(files, found, strict=True))


def table_outcome(file: SentFile, carried: Carried) -> Outcome:
    """A table of one's own layout, as its page gets it."""
    return Outcome(file.filename, is_table=True, carried=carried)


def job_outcome(job: Job) -> Outcome:
    """A large file that a job works on, or that became nothing."""
    return Outcome(job.subject, job=job, progress=progress_of(job) or ending_of(job))


def _outcome(filename: str, one: Receipt | RefusedError, summary: Callable[[str], DiagnosisSummary | None]) -> Outcome:
    if isinstance(one, RefusedError):
        return Outcome(filename, problems=one.problems)
    made = summary(one.id)
    return Outcome(filename, one, diagnosis=diagnosis_line(made), pending=made is None)


def outcome_of(session: StoredSession, made: DiagnosisSummary | None) -> Outcome:
    """What became of a file that was uploaded a while ago."""
    known = {f.name: getattr(session, f.name) for f in fields(Receipt) if f.name != "created"}
    return Outcome(session.filename, Receipt(created=True, **known), (), diagnosis_line(made), made is None)


def upload_page(outcomes: Sequence[Outcome], settings: Settings, unit_types: Sequence[str] = ()) -> UploadPage:
    """The page before (no outcomes) or after an upload."""
    follows = settings.diagnosis_workers > 0
    most, log = _limit(in_force().whole), _limit(in_force().log)
    return UploadPage(tuple(outcomes), most, log, follows, tuple(unit_types))


def _limit(size: int) -> str:
    """``64 MiB``, ``2 GiB``."""
    return f"{size / 2**30:.4g} GiB" if size >= 2**30 else f"{size / 2**20:.4g} MiB"
