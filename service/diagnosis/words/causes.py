"""Names of causes: one alone, one on its sensors, and several that a session cannot distinguish."""

from collections.abc import Sequence

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.groups.fixed import EMPIRICAL
from estimator.groups.layout import EVERY
from estimator.message import joined, say, without_stop
from service.kit.measures import HARD, number, spaced

UNKNOWN_CAUSE = "unexplained"
"""Stands among the alternatives of a finding that a cause which is not in the catalogue explains as well."""
EVERY_SENSOR = "every sensor of its kind"
"""Name for all sensors where a group's finding acts on all of them."""
LEARNED = "empirical term"
"""Name of a learned term, in place of a cause."""
ONE_NOT_KNOWN = "a cause outside the catalogue"
COMPARABLE = 3.0
"""Times that one share of probability may be another's and both still pass for equally likely: evidence below that is
not worth a mention (Jeffreys)."""
SHOWN_SHARE = 5e-4
"""Share of probability that is still shown: what rounds to a tenth of a per cent."""
MOST_NAMES = 3
"""Causes that a sentence lists before it counts the rest: more than three are no longer read."""


def cause_name(identifier: str) -> str:
    """``bias temperature``; a cause that this version does not know is called by its identifier."""
    if identifier == UNKNOWN_CAUSE:
        return ONE_NOT_KNOWN
    if identifier == EMPIRICAL:
        return LEARNED
    known = find(identifier)
    return spaced(identifier) if known is None else known.name


def cause_on(identifier: str, sensors: Sequence[str]) -> str:
    """``bias temperature (A5)``."""
    return cause_name(identifier) + _on(sensors)


def weighty_first(findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings in the order of reading; the seating of the block since earlier sessions, which is no ground for the
    verdict, comes last.
    """
    return tuple(sorted(findings, key=_is_seating))


def _is_seating(finding: Finding) -> bool:
    known = find(finding.cause)
    return known is not None and known.scope == "fixture" and known.between


def is_lone(finding: Finding) -> bool:
    """Whether it is the only known cause that fits, beside one that is not in the catalogue."""
    return finding.alternatives == (UNKNOWN_CAUSE,)


def what_is_wrong(finding: Finding, findings: Sequence[Finding] = ()) -> str:
    """The fault in a sentence; the names of several causes: ``Cannot tell which: ramp or warm up (A3).``

    ``findings``: all of the diagnosis. A sensor with two names has two causes at once, or one that nobody knows.
    """
    if not finding.alternatives:
        return finding.sentence
    at_once = at_once_with(finding, findings)
    if at_once:
        count, names = "Two" if len(at_once) == 2 else "Several", joined(" and ", map(cause_name, at_once))
        parts = {"count": count, "one_not_known": ONE_NOT_KNOWN, "sensors": _on(finding.sensors), "names": names}
        return say("{count} causes at once, or {one_not_known}{sensors}: {names}.", **parts)
    if is_lone(finding):
        return say("{choice}.", choice=choice_of(finding))
    likely, unlikely = by_share(finding)
    if len(likely) > 1 or not unlikely:
        less = say("; {unlikely}", unlikely=_less(unlikely, finding)) if unlikely else ""
        return say(
            "Cannot tell which: {likely}{sensors}{less_likely}.",
            likely=_listed(_with_unknown(likely, finding)),
            sensors=_on(finding.sensors),
            less_likely=less,
        )
    first, unknown = (
        likely[0],
        say(", or {one_not_known}", one_not_known=ONE_NOT_KNOWN) if UNKNOWN_CAUSE in finding.alternatives else "",
    )
    return say(
        "{cause} ({share} likely); {unlikely}{unknown}.",
        cause=without_stop(finding.sentence) if first == finding.cause else cause_on(first, finding.sensors),
        share=share_of(first, finding),
        unlikely=_less(unlikely, finding),
        unknown=unknown,
    )


def choice_of(finding: Finding) -> str:
    """The causes that a finding leaves standing, in a clause: ``The bias of A3 drifts, or possibly warm up``; of a lone
    one its share, where that was kept."""
    if is_lone(finding) and any(rival.cause == UNKNOWN_CAUSE for rival in finding.ranking):
        return say(
            "{cause} ({share} likely), or {one_not_known}",
            cause=without_stop(finding.sentence),
            share=share_of(finding.cause, finding),
            one_not_known=ONE_NOT_KNOWN,
        )
    others = (name for names in by_share(finding) for name in names if name != finding.cause)
    return say(
        "{cause}, or possibly {others}",
        cause=without_stop(finding.sentence),
        others=_listed(_with_unknown(tuple(others), finding)),
    )


def by_share(finding: Finding) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The known causes of a choice, likeliest first: those that are about equally likely, and those that are less."""
    names = [name for name in (finding.cause, *finding.alternatives) if name != UNKNOWN_CAUSE]
    shares = {name: _share(name, finding) for name in names}
    names.sort(key=lambda name: -shares[name])
    likely = tuple(name for name in names if COMPARABLE * shares[name] >= shares[names[0]])
    return likely, tuple(name for name in names if name not in likely)


def is_level(finding: Finding) -> bool:
    """Whether the causes of a choice are about equally likely."""
    return not by_share(finding)[1]


def share_of(name: str, finding: Finding) -> str:
    """``98 %``: of a cause on any sensors, among all that are possible."""
    return percent(_share(name, finding))


def _share(name: str, finding: Finding) -> float:
    return sum(rival.probability for rival in finding.ranking if rival.cause == name)


def percent(share: float) -> str:
    """A share of probability as people read it."""
    if share > 1 - SHOWN_SHARE:
        return say("over 99.9{nbsp}%", nbsp=HARD)
    return f"{number(100 * share, 1)}{HARD}%" if share > SHOWN_SHARE else say("under 0.1{nbsp}%", nbsp=HARD)


def _less(unlikely: Sequence[str], finding: Finding) -> str:
    """``less likely odd quadratic, 5.3 %``; a share that the ranking does not show is none to state."""
    ranked = {rival.cause for rival in finding.ranking}
    shown = [
        say(
            "{name}{share}",
            name=cause_name(name),
            share=say(", {name}", name=share_of(name, finding)) if name in ranked else "",
        )
        for name in unlikely[:MOST_NAMES]
    ]
    more = len(unlikely) - MOST_NAMES
    return "less likely " + joined("; ", (*shown, *([say("{number} more", number=more)] if more > 0 else [])))


def _with_unknown(names: Sequence[str], finding: Finding) -> tuple[str, ...]:
    return (*names, *(name for name in finding.alternatives if name == UNKNOWN_CAUSE))


def at_once_with(finding: Finding, findings: Sequence[Finding]) -> tuple[str, ...]:
    """The causes, strongest first, that act together where an unknown one alone would do; empty where none do."""
    if not (is_lone(finding) and finding.sensors):
        return ()
    causes = tuple(f.cause for f in findings if f.sensors == finding.sensors)
    return causes if len(causes) > 1 else ()


def _on(sensors: Sequence[str]) -> str:
    names = (EVERY_SENSOR if sensor == EVERY else sensor for sensor in dict.fromkeys(sensors))
    return say(" ({names})", names=joined(", ", names)) if sensors else ""


def _listed(causes: Sequence[str]) -> str:
    """``a, b or c``; of many only the first three, and always that it may be an unknown one."""
    names = [cause_name(identifier) for identifier in causes if identifier != UNKNOWN_CAUSE]
    shown, more = names[:MOST_NAMES], len(names) - MOST_NAMES
    shown += [say("{number} more", number=more)] if more > 0 else []
    shown += [ONE_NOT_KNOWN] if UNKNOWN_CAUSE in causes else []
    if len(shown) == 1:
        return shown[0]
    return say("{first} or {last}", first=joined(", ", shown[:-1]), last=shown[-1])
