"""The page of figures: targets, confusion matrix, detection curve, false alarms, amplitudes."""

from collections import Counter
from collections.abc import Callable, Iterable
from statistics import fmean

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from tests.blind.catalogue import CATALOGUE
from tests.blind.score import Outcome

BINS = ((2, 3), (3, 4), (4, 5), (5, 6.5), (6.5, 8), (8, 12), (12, 18), (18, 27), (27, 1e9))

FEW = 10
"""A cause with fewer sessions has no row of its own: an interval of three trials says nothing."""

INTRODUCTION = (
    "Unit, stand, schedule, temperature, order, noise and effect are drawn at random; the physics is written a second "
    "time, apart from the estimator. Strength is the norm of what the baseline leaves of an effect, in standard errors "
    "of a reading; separation the norm of what is left of it after the best fit of a rival. Intervals: 95 % (Wilson)."
)


def page(outcomes: list[Outcome], command: str) -> str:
    """Markdown."""
    made = f"{len(outcomes)} simulated sessions, made by `{command}`."
    parts = [
        f"# How well hidden effects are found\n\n{made} {INTRODUCTION}",
        _targets(outcomes),
        in_full(f"{_by_cause(outcomes)}\n\n{_confusion(outcomes)}"),
        _curve(outcomes),
        in_full(_false_alarms(outcomes)),
        in_full(f"{_outside(outcomes)}\n\n{_two(outcomes)}\n\n{_amplitudes(outcomes)}"),
    ]
    return "\n\n".join(parts) + "\n"


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A Markdown table."""
    names = list(head)
    lines = ["| " + " | ".join(names) + " |", "| " + " | ".join("---" for _ in names) + " |"]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def of_kind(outcomes: list[Outcome], kind: str) -> list[Outcome]:
    """The outcomes of one kind."""
    return [o for o in outcomes if o.kind == kind]


def mean(values: Iterable[float]) -> str:
    """Two digits, or a dash of nothing."""
    listed = list(values)
    return f"{fmean(listed):.2f}" if listed else "–"


def pulls_inside(outcomes: list[Outcome]) -> list[bool]:
    """Whether each amplitude of a single effect is within two of its own sigma."""
    return [abs(p.value) <= 2 for o in of_kind(outcomes, "single") for p in o.pulls]


def _targets(outcomes: list[Outcome]) -> str:
    single, none, two = (of_kind(outcomes, kind) for kind in ("single", "none", "two"))
    apart = [o for o in single if o.separated]
    rows = [
        ("named first where separated by 5", "≥ 97 %", rate([o.first for o in apart])),
        ("alternatives there, mean", "≤ 0.5", mean(len(o.alternatives) for o in apart)),
        ("named first or among the alternatives, all", "≥ 99 %", rate([o.listed for o in single])),
        ("alternatives, mean over all", "≤ 2", mean(len(o.alternatives) for o in single)),
        ("a name where there is no effect", "≤ 1 %", rate([bool(o.findings) for o in none])),
        ("`unexplained` where there is no effect", "", rate([o.unexplained for o in none])),
        ("outside the catalogue: `unexplained`", "≥ 95 %", rate([o.unexplained for o in of_kind(outcomes, "outside")])),
        ("two effects, separated by 5: both named", "≥ 90 %", rate([all(o.named) for o in two if o.separated])),
        ("two effects, all: both named or listed", "≥ 90 %", rate([all(o.offered) for o in two])),
        ("amplitudes within two of their own sigma", "93–97 %", rate(pulls_inside(outcomes))),
        ("time of one diagnosis, mean", "", f"{mean(o.seconds for o in outcomes)} s"),
    ]
    return "## Targets\n\n" + table(("figure", "target", "measured"), rows)


def _by_cause(outcomes: list[Outcome]) -> str:
    rows = []
    for cause in CATALOGUE:
        own = [o for o in of_kind(outcomes, "single") if o.causes == (cause,)]
        apart = [o for o in own if o.separated]
        rows.append(
            (
                f"`{cause}`",
                rate([o.first for o in apart]),
                rate([o.listed for o in own]),
                mean(len(o.alternatives) for o in own),
                ", ".join(f"{name} {n}" for name, n in Counter(o.rivals[0] for o in own).most_common(2) if name),
            )
        )
    head = ("cause", "first where separated", "first or alternative", "alternatives", "nearest rivals")
    return "## Cause by cause\n\n" + table(head, rows)


def named(outcome: Outcome) -> str:
    """The cause of the first finding, marked where only the sensor is wrong."""
    if not outcome.findings:
        return "unexplained" if outcome.unexplained else "nothing"
    cause = outcome.findings[0].split("@")[0]
    return f"{cause} (other sensor)" if cause in outcome.causes and not outcome.first else cause


def _confusion(outcomes: list[Outcome]) -> str:
    def wrong_rows(choose: Callable[[Outcome], bool]) -> Iterable[tuple[str, str, str]]:
        for cause in CATALOGUE:
            own = [o for o in of_kind(outcomes, "single") if o.causes == (cause,) and choose(o)]
            counts = Counter(named(o) for o in own)
            right = counts.pop(cause, 0)
            wrong = ", ".join(f"{name} {n}" for name, n in counts.most_common())
            if wrong:
                yield f"`{cause}`", f"{right} / {len(own)}", wrong

    head = ("hidden", "named", "named instead")
    return (
        "## Confusion matrix\n\nThe first name, one effect; causes that are always named first are left out.\n\n"
        "### Separated from every rival by 5\n\n"
        + table(head, wrong_rows(lambda o: o.separated))
        + "\n\n### Nearer to a rival than that\n\n"
        + table(head, wrong_rows(lambda o: not o.separated))
    )


def _curve(outcomes: list[Outcome]) -> str:
    hidden = [o for o in outcomes if o.kind in ("single", "weak")]
    groups = [("all causes", hidden)]
    causes = [(f"`{cause}`", [o for o in hidden if o.causes == (cause,)]) for cause in CATALOGUE]
    groups += [(name, group) for name, group in causes if len(group) >= FEW]
    rows = []
    for name, group in groups:
        cells = []
        for low, high in BINS:
            inside = [o for o in group if low <= o.strengths[0] < high]
            r = rate([o.listed for o in inside])
            cells.append(f"{100 * r.share:.0f} % of {r.trials}" if inside else "–")
        rows.append((name, *cells))
    head = ["cause", *(f"{low:g}–{high:g}" if high < 1e6 else f"above {low:g}" for low, high in BINS)]
    text = "Share named first or among the alternatives against strength."
    return in_full(f"## Detection curve\n\n{text}\n\n{table(head, rows)}")


def _false_alarms(outcomes: list[Outcome]) -> str:
    none = of_kind(outcomes, "none")
    names = Counter(f.split("@")[0] for o in none for f in o.findings)
    rows = [
        ("all", rate([bool(o.findings) for o in none])),
        ("noise stated", rate([bool(o.findings) for o in none if not o.unstated_noise])),
        ("noise not stated", rate([bool(o.findings) for o in none if o.unstated_noise])),
        ("with a history", rate([bool(o.findings) for o in none if o.history])),
    ]
    listed = ", ".join(f"{name} {n}" for name, n in names.most_common()) or "none"
    return (
        f"## False alarms\n\n{table(('sessions without an effect', 'named something'), rows)}\n\nNames given: {listed}."
    )


def _outside(outcomes: list[Outcome]) -> str:
    own = of_kind(outcomes, "outside")
    rows = []
    for kind in sorted({o.causes[0] for o in own}):
        group = [o for o in own if o.causes[0] == kind]
        names = Counter(f.split("@")[0] for o in group for f in o.findings)
        listed = ", ".join(f"{name} {n}" for name, n in names.most_common(4)) or "–"
        rows.append((kind, rate([o.unexplained for o in group]), rate([bool(o.findings) for o in group]), listed))
    return "## Structure outside the catalogue\n\n" + table(("structure", "`unexplained`", "got a name", "names"), rows)


def _two(outcomes: list[Outcome]) -> str:
    own = of_kind(outcomes, "two")
    apart = [o for o in own if o.separated]
    rows = [
        ("both named", rate([all(o.named) for o in own]), rate([all(o.named) for o in apart])),
        ("both named or listed", rate([all(o.offered) for o in own]), rate([all(o.offered) for o in apart])),
        ("at least one named", rate([any(o.named) for o in own]), rate([any(o.named) for o in apart])),
        ("more than two names", rate([len(o.findings) > 2 for o in own]), rate([len(o.findings) > 2 for o in apart])),
    ]
    missed = Counter(c for o in own for c, ok in zip(o.causes, o.named, strict=True) if not ok)
    listed = ", ".join(f"{name} {n}" for name, n in missed.most_common(12)) or "none"
    return "## Two effects at once\n\n" + table(("", "all", "both separated by 5"), rows) + f"\n\nMissed: {listed}."


def _amplitudes(outcomes: list[Outcome]) -> str:
    rows = []
    pulls = [p for o in of_kind(outcomes, "single") for p in o.pulls]
    groups = [("all causes", [p.value for p in pulls])]
    causes = [(f"`{cause}`", [p.value for p in pulls if p.cause == cause]) for cause in CATALOGUE]
    groups += [(name, values) for name, values in causes if len(values) >= FEW]
    for name, values in groups:
        if values:
            spread = fmean([v * v for v in values]) ** 0.5
            rows.append((name, rate([abs(v) <= 2 for v in values]), f"{fmean(values):+.2f}", f"{spread:.2f}"))
    head = ("cause", "within two sigma", "mean", "root mean square")
    return "## Amplitudes, (estimate − truth) / sigma\n\n" + table(head, rows)
