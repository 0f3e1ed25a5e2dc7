"""A term that sessions taught, in words: its equation in people's measures, its worth, and what comes near it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from estimator.groups.fixed import EMPIRICAL
from estimator.groups.results import EmpiricalTerm, GroupGain
from estimator.message import capitalised, joined, say
from service.diagnosis.words.amplitude_measures import amplitude_measure
from service.diagnosis.words.causes import cause_name
from service.kit.measures import COVERAGE, HARD, measured, number
from service.models.records import SCOPES, ModelRevision

READS = "{sensor} reads more by"
TURNS = {"δα": "the elevation α is more by", "δβ": "the angle β is more by"}
"""How a line of a term begins, by the angle that it turns."""


@dataclass(frozen=True)
class TermView:
    """A learned term, for people."""

    lines: tuple[tuple[str, str], ...]
    """What is more, and by how much."""
    whose: str
    """Whose sessions taught it."""
    worth: str
    nearest: str
    sensors: tuple[str, ...] = ()
    model: str = ""
    """Whose model it can become part of: ``unit BA-017``; empty where the sessions name none."""
    accepted: tuple[int, ...] = ()
    """Revisions in force that hold it."""


def term_view(term: EmpiricalTerm, accepted: Sequence[ModelRevision] = ()) -> TermView:
    """What an engineer reads of a learned term; ``accepted``: the revisions that are in force."""
    scope = SCOPES.get(term.level) if term.subject else None
    near = say("{separation} standard errors from it", separation=number(term.separation, 1))
    return TermView(
        lines=tuple(_lines(term)),
        whose=term.subject,
        worth=say(
            "It removes {explained}{hard}% of what the sessions that took no part in learning it show too much.",
            explained=number(100 * term.explained, 0),
            hard=HARD,
        ),
        nearest=say("Nearest in the catalogue: {nearest}, {near}.", nearest=cause_name(term.nearest), near=near)
        if term.nearest
        else "",
        sensors=term.sensors,
        model="" if scope is None else say("{scope} {subject}", scope=scope, subject=term.subject),
        accepted=tuple(r.id for r in accepted if holds_term(r, term)),
    )


def holds_term(revision: ModelRevision, term: EmpiricalTerm) -> bool:
    """Whether a revision accepted a learned term of this place: an equation that was learned anew is another one of
    it, and not beside it."""
    own = (revision.cause, revision.scope, revision.subject, revision.sensors)
    return own == (EMPIRICAL, SCOPES.get(term.level), term.subject, term.sensors)


def equation_of(term: EmpiricalTerm) -> str:
    """``A3 reads more by (3.1 ± 0.2) µg · sin 3β.``"""
    return joined(
        " ", (say("{what} {equation}.", what=capitalised(what), equation=equation) for what, equation in _lines(term))
    )


def _lines(term: EmpiricalTerm) -> Iterator[tuple[str, str]]:
    """One for the sensor, or for each angle of the applied vector that is turned."""
    found: dict[str, list[str]] = {}
    for word, value, sigma, unit in zip(term.words, term.amplitude, term.sigma, term.units, strict=True):
        target, _, factor = word.rpartition(": ")
        spread = COVERAGE * sigma
        measure = amplitude_measure("", unit, max(abs(value), spread))
        found.setdefault(target, []).append(
            say("({size}){hard}·{hard}{factor}", size=measured(value, spread, measure), hard=HARD, factor=factor)
        )
    for target, parts in found.items():
        yield TURNS.get(target, say(READS, sensor=joined(", ", term.sensors))), joined(" + ", parts)


def gain_in_words(gain: GroupGain | None) -> str:
    """What the findings are worth for sessions that came later; empty where there were too few."""
    if gain is None:
        return ""
    before, after = (number(x, 3) for x in (gain.chi2_per_dof_before, gain.chi2_per_dof_after))
    likelier = (
        say("{log_score} more", log_score=number(gain.log_score, 1))
        if gain.log_score > 0
        else say("{log_score} less", log_score=number(-gain.log_score, 1))
    )
    return say(
        "Sizes fixed on the first {fitted} sessions, tried on the {held_out} that came later: "
        "their χ² per degree of freedom goes from {before} to {after}, their log score is "
        "{likelier}.",
        fitted=gain.fitted,
        held_out=gain.held_out,
        before=before,
        after=after,
        likelier=likelier,
    )
