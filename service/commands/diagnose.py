"""`imu-health diagnose`: errors of the simulation for session files, without a server.

The cause and what to do come first, then its size, alternatives, gain and limits.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from estimator import diagnose
from estimator.diagnosis import Diagnosis
from estimator.diagnosis.results import Limit, Score, Structure
from estimator.session import DIAGNOSED, CalibrationSession
from estimator.wording import counted
from service.commands.console import AsJson, Files, for_each, print_json, screen, usable
from service.commands.speech import translated
from service.diagnosis.records import state_of
from service.diagnosis.store import inapplicable_to_dict
from service.diagnosis.words.diagnosis import NOT_APPLICABLE, blind_causes, errors_of, nothing_of, what_to_do
from service.diagnosis.words.findings import FindingView, finding_view, in_words, standard_errors
from service.diagnosis.words.gain import concerned, gain_in_words
from service.ingest import read_file
from service.kit.measures import number
from service.sessions.records import DiagnosisState

COLOURS = {
    DiagnosisState.NOTHING: "green",
    DiagnosisState.NAMED: "dark_orange",
    DiagnosisState.UNDECIDED: "blue",
    DiagnosisState.UNEXPLAINED: "magenta",
}
NEXT = slice(1, 3)
"""Lines of the ranking next to the named cause."""
Result = tuple[CalibrationSession, Diagnosis | None]
"""A session with its diagnosis; None for a programme without one."""
History = Annotated[
    list[Path] | None,
    typer.Option(help="An earlier session of the unit; repeat it for more, oldest first.", show_default=False),
]


def diagnose_files(files: Files, as_json: AsJson = False, history: History = None) -> None:
    """Say what the simulation gets wrong: the cause with its size, what else it could be, and what cannot be seen."""
    earlier = [_earlier(file) for file in history or ()]
    show: Callable[[Result], None] = _print_json if as_json else _print_view
    for_each(files, lambda file: _diagnosed(file, earlier), show, "diagnosing", quiet=as_json)


def _earlier(file: Path) -> CalibrationSession:
    """An earlier session; it must be readable, since without it the answer would differ."""
    with usable(file):
        return read_file(file)


def _diagnosed(file: Path, earlier: list[CalibrationSession]) -> Result:
    session = read_file(file)
    return session, diagnose(session, history=earlier) if session.programme in DIAGNOSED else None


def _print_json(result: Result) -> None:
    session, diagnosis = result
    print_json(inapplicable_to_dict(session.unit) if diagnosis is None else diagnosis.to_dict())


def _print_view(result: Result) -> None:
    screen().print(diagnosis_view(*result))


def diagnosis_view(session: CalibrationSession, diagnosis: Diagnosis | None) -> RenderableType:
    """The whole diagnosis of one session; None for a programme without diagnosis."""
    when = f", {session.started_at}" if session.started_at else ""
    heading = Text.assemble((session.unit, "bold"), when)
    lines = [Text(translated(NOT_APPLICABLE), "yellow")] if diagnosis is None else _lines_of(diagnosis)
    return Group(heading, *lines, Text(""))


def _lines_of(diagnosis: Diagnosis) -> Iterator[RenderableType]:
    state = state_of(diagnosis)
    for finding in diagnosis.findings:
        yield from _finding(finding_view(finding, (), diagnosis.findings), COLOURS[state])
    for structure in diagnosis.structures:
        yield Text(translated(_structure(structure)), COLOURS[DiagnosisState.UNEXPLAINED])
    if state is DiagnosisState.UNEXPLAINED:
        yield Text(f"  What to do: {translated(what_to_do(diagnosis))}")
    if not diagnosis.findings and not diagnosis.structures:
        yield Text(translated(nothing_of(diagnosis)), COLOURS[state])
    else:
        yield from (Text(translated(sentence), "yellow") for sentence in errors_of(diagnosis))
    yield from (Text(translated(note)) for note in diagnosis.notes)
    if diagnosis.findings:
        yield from _gain(diagnosis)
    yield from _unseen(diagnosis.limits)


def _finding(finding: FindingView, colour: str) -> Iterator[RenderableType]:
    """The cause or the alternatives, then the evidence."""
    yield Text(translated(finding.statement), f"bold {colour}")
    if finding.doubtful and not finding.lone:
        yield _choices(finding)
    else:
        yield Text(f"  {'If it appears again' if finding.lone else 'What to do'}: {translated(finding.advice)}")
    size = ", ".join(finding.amplitudes)
    parts = [f"size {size}" if size else "", finding.shape, finding.evidence, finding.since]
    yield Text("  " + "; ".join(part.rstrip(".") for part in parts if part))
    if len(finding.ranking) > 1 and (finding.lone or not finding.doubtful):
        others = ", ".join(f"{bar.name} {bar.percent}" for bar in finding.ranking[NEXT])
        yield Text(f"  Next in the ranking: {others}", "dim")


def _choices(finding: FindingView) -> Table:
    table = Table(box=None, pad_edge=True, header_style="bold", padding=(0, 2, 0, 0))
    for heading in ("cause", "share", "distance now", "what would distinguish it from the first"):
        table.add_column(heading)
    for choice in finding.choices:
        table.add_row(escape(choice.name), choice.share, choice.now or "–", choice.measurement or "–")
    return table


def _structure(structure: Structure) -> str:
    return f"{in_words([structure]).rstrip('.')} ({standard_errors(structure.strength)})"


def _gain(diagnosis: Diagnosis) -> Iterator[Text]:
    """One sentence for everybody, then the scores for experts."""
    gain = diagnosis.gain
    if sentence := gain_in_words(gain, concerned(diagnosis.findings)):
        yield Text(f"  {translated(sentence)}")
    yield Text(_scores(f"Predicting {gain.held_out} held out of the estimation", gain.before, gain.after), "dim")
    if gain.session is not None:
        started = gain.session.started_at or "no stated date"
        before = f"Predicting the session before ({started})"
        yield Text(_scores(before, gain.session.before, gain.session.after), "dim")


def _scores(label: str, before: Score, after: Score) -> str:
    chi2 = " → ".join(number(score.chi2_per_dof, 2) for score in (before, after))
    log = " → ".join(number(score.log_score, 2) for score in (before, after))
    return f"  {label}: χ² per degree of freedom {chi2}, log score {log}"


def _unseen(limits: Sequence[Limit]) -> Iterator[Text]:
    """Causes that this session cannot show, by reason; and the number of limits in --json."""
    for row in blind_causes(limits):
        yield Text(f"  Not detectable ({row.reason}): {row.causes}", "dim")
    seen = sum(bool(limit.amplitude) for limit in limits)
    yield Text(f"  Smallest detectable effects: {counted(seen, 'cause')}, see --json", "dim")
