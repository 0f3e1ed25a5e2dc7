"""What a session that is being measured still lacks, by its file so far; nothing is stored."""

from estimator.errors import SessionError
from estimator.planning import Missing, missing
from service.errors import RefusedError
from service.ingest import in_turn, read_upload
from service.ingest.layout.envelope import wrapped
from service.records.received import SentFile, held, where


def missing_of(file: SentFile, positions: int | None, *, both_runs: bool) -> Missing:
    """What is to come; RefusedError with every problem where the file cannot be read so far."""
    content = where(file.content) if file.mapping is None else wrapped(file.mapping, held(file.content))
    try:
        with in_turn(content):
            return missing(read_upload(content, file.filename), positions, both_runs=both_runs)
    except SessionError as fault:
        raise RefusedError(f"{file.filename} cannot be read so far.", fault.problems) from fault
