"""Leave one cause out: a strong effect is hidden, and looked for with a catalogue that lacks its cause."""

from collections import Counter
from itertools import cycle, islice

from benchmarks.details import in_full
from benchmarks.study.examine import Task
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from tests.blind.cases import LEFT_OUT
from tests.blind.catalogue import CATALOGUE
from tests.blind.score import FAR, Outcome

SCREENED = "reading-outlier"
"""The cause that is named whatever the catalogue holds: one reading far off is set aside before any cause is sought."""

INTRODUCTION = (
    "Every cause of the catalogue but `reading-outlier`, which is found before any other is sought, is hidden in turn "
    "at a strength of 40 standard errors and looked for with a catalogue that lacks it. Where no other explanation "
    "comes within 10 standard errors of it, the right answer is `unexplained`."
)


def tasks(sessions: int, seed: int) -> list[Task]:
    """The whole catalogue in turn, but what is screened."""
    every = enumerate(islice(cycle(CATALOGUE), sessions))
    return [Task(LEFT_OUT, (seed, i), cause) for i, cause in every if cause != SCREENED]


def far(outcomes: list[Outcome]) -> list[Outcome]:
    """The outcomes whose cause no other explanation comes near."""
    return [o for o in outcomes if min(o.separations) >= FAR]


def section(outcomes: list[Outcome]) -> str:
    """Markdown."""
    apart = far(outcomes)
    rows = [
        (
            "a wrong name, `unexplained` neither beside it nor among its alternatives",
            "≤ 2 %",
            rate([bool(o.findings) and not o.unexplained_listed for o in apart]),
        ),
        ("any wrong name", "≤ 10 %", rate([bool(o.findings) for o in apart])),
        ("`unexplained` answered or listed", "≥ 95 %", rate([o.unexplained_listed for o in apart])),
        ("nearer to a rival than 10: `unexplained` answered or listed", "", _listed_near(outcomes)),
    ]
    figures = table(("figure", "target", "measured"), rows)
    head = ("left out", "no rival within 10", "wrong name", "`unexplained` answered or listed", "names given")
    told = [_row(cause, apart) for cause in CATALOGUE if not _is_clean([o for o in apart if o.causes == (cause,)])]
    by_cause = in_full(f"Causes with a wrong name or without `unexplained`:\n\n{table(head, told)}")
    return f"## One cause left out\n\n{INTRODUCTION}\n\n{figures}\n\n{by_cause}"


def _is_clean(outcomes: list[Outcome]) -> bool:
    return all(o.unexplained_listed and not o.findings for o in outcomes)


def _listed_near(outcomes: list[Outcome]) -> str:
    return str(rate([o.unexplained_listed for o in outcomes if min(o.separations) < FAR]))


def _row(cause: str, apart: list[Outcome]) -> tuple[object, ...]:
    own = [o for o in apart if o.causes == (cause,)]
    names = Counter(f.split("@")[0] for o in own for f in o.findings)
    return (
        f"`{cause}`",
        len(own),
        sum(bool(o.findings) for o in own),
        sum(o.unexplained_listed for o in own),
        ", ".join(f"{name} {n}" for name, n in names.most_common()) or "–",
    )
