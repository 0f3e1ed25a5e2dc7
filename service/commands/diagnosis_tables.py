"""A diagnosis as people read it: the cause and what to do first, then its size, rivals, gain and limits."""

from collections.abc import Iterator
from typing import Any

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from estimator.session import CalibrationSession
from service.measures import number
from service.pages.limits import limits_view
from service.records.diagnosis import DiagnosisState
from service.words.diagnosis import NOT_APPLICABLE, NOTHING, UNEXPLAINED
from service.words.finding import FindingView, finding_view

COLOURS = {
    DiagnosisState.NAMED: "dark_orange",
    DiagnosisState.UNDECIDED: "blue",
    DiagnosisState.UNEXPLAINED: "magenta",
}
UNNAMED = {DiagnosisState.NOTHING: (NOTHING, "green"), DiagnosisState.NOT_APPLICABLE: (NOT_APPLICABLE, "yellow")}


def diagnosis_view(session: CalibrationSession, document: dict[str, Any], state: DiagnosisState) -> RenderableType:
    """The whole diagnosis of one session."""
    findings = [finding_view(finding) for finding in document["findings"]]
    when = f", {session.started_at}" if session.started_at else ""
    parts: list[RenderableType] = [Text.assemble((session.unit, "bold"), when)]
    for finding in findings:
        parts += _finding(finding, COLOURS[state])
    for structure in document["structures"]:
        parts.append(Text(_structure(structure), COLOURS[DiagnosisState.UNEXPLAINED]))
    if state in UNNAMED:
        parts.append(Text(*UNNAMED[state]))
    if findings:
        parts.append(Text(_gain(document["gain"])))
    return Group(*parts, *_unseen(document["limits"]), Text(""))


def _finding(finding: FindingView, colour: str) -> Iterator[RenderableType]:
    """The name or the choice, then the evidence."""
    if finding.doubtful:
        yield Text("Cannot tell which of these it is:", f"bold {colour}")
        yield _choices(finding)
    else:
        yield Text(finding.sentence, f"bold {colour}")
        yield Text(f"  What to do: {finding.advice}")
    size = ", ".join(finding.amplitudes)
    parts = [f"size {size}" if size else "", finding.shape, finding.evidence, finding.since]
    yield Text("  " + "; ".join(part.rstrip(".") for part in parts if part))
    if len(finding.ranking) > 1 and not finding.doubtful:
        listed = ", ".join(f"{bar.name} {bar.percent}" for bar in finding.ranking[1:3])
        yield Text(f"  Next in the ranking: {listed}", "dim")


def _choices(finding: FindingView) -> Table:
    table = Table(box=None, pad_edge=True, header_style="bold", padding=(0, 2, 0, 0))
    for heading in ("cause", "share", "distance now", "what would tell it from the first"):
        table.add_column(heading)
    for choice in finding.choices:
        table.add_row(escape(choice.name), choice.share, choice.now or "–", choice.measurement or "–")
    return table


def _structure(structure: dict[str, Any]) -> str:
    who = ", ".join(structure["sensors"]) or "all sensors together"
    return f"{UNEXPLAINED}: {who}, {structure['where']} ({number(structure['strength'], 1)} standard errors)"


def _gain(gain: dict[str, Any]) -> str:
    lines = [_scores("Predicting positions held out of the fit", gain)]
    if gain["session"] is not None:
        started = gain["session"]["started_at"] or "no stated date"
        lines.append(_scores(f"Predicting the session before ({started})", gain["session"]))
    return "\n".join(lines)


def _scores(what: str, gain: dict[str, Any]) -> str:
    before, after = gain["before"], gain["after"]
    chi2 = " → ".join(number(part["chi2_per_dof"], 2) for part in (before, after))
    log = " → ".join(number(part["log_score"], 2) for part in (before, after))
    return f"  {what}: χ² per degree of freedom {chi2}, log score {log}"


def _unseen(limits: list[dict[str, Any]]) -> Iterator[Text]:
    """What this session cannot see, by reason; and how many limits --json states."""
    view = limits_view(limits)
    for row in view.blind:
        yield Text(f"  Not seen ({row.reason}): {row.causes}", "dim")
    yield Text(f"  Smallest effects that would have been found: {len(view.seen)} causes, see --json", "dim")
