"""The page of evidence of many sessions: explanation, and the table of the study."""

from collections.abc import Iterator
from statistics import fmean, median
from typing import Any

from benchmarks.details import in_full
from benchmarks.study.rates import rate

EXPLANATION = """# Evidence of many sessions

A session shows an effect from about five standard errors. Thirty sessions of a unit, stand or type show one of strength
1 in each as plainly.

## What is kept of a session

`statistics_of(session)` keeps, for every cause that can last at every place and shape, its *score* U (how much of it
the residuals hold) and *information* F (how much they could hold). Clipped channels, record errors
and outliers are corrected first; the scatter is that which the session shows.
The amplitude of a group is â = (ΣF)⁻¹ΣU with covariance (ΣF)⁻¹.

## Whose it is

| level | effects | rivals |
| --- | --- | --- |
| unit | a sensor's or its environment's, on one unit | the same on every unit of the type, a cause of the stand |
| type | the same of the sensor of one name in every unit, or of every sensor of a kind | one unit's, the stand's |
| stand | of stand and fixture, over all units; a sensor cause that every sensor measured there shares | the units' |

The same units on another stand separate two levels that explain alike.

## When a name is given

One model explains all sessions: z of a session is the sum of the columns of its terms times their amplitudes, and
noise. A term is a cause, or a wave without a name, at a place; its amplitude is the *same* in all sessions, *varying*,
or there *since* one of them. Amplitudes have normal priors of 0.5, 2 and 8 standard errors of the first session that
sees them, so that the evidence follows from U and F alone ([constants and reasons](../../estimator/groups/priors.py)).

* The likeliest term joins while the *e-value* of all of them reaches 100: valid however often one looks, it does so in
  at most one group of a hundred without an effect. Each is weighed again given the others.
* A term holds without any one session; on a type or a stand without any one unit. What one shows by itself is left
  free there.
* At its place a name is held against an unknown course: few terms of a library of two hundred that no single cause
  describes (products of input, its size, sign and powers, cross-axis input, temperature, its square, rate and lag,
  time, waves of β, the row before), with odds of one in six. Where the course is likelier the names are withdrawn:
  *unexplained*, with its equation. From a probability of 0.5 %, or where sessions differ in size (`varying`, or
  Cochran's test at 1 %), `unexplained` is among the alternatives.

## What an answer holds

| field | meaning |
| --- | --- |
| `amplitude`, `sigma`, `spread` | mean over sessions in SI, and τ between them (random effects) |
| `form`, `since` | `same`, `varying` or `since` a date |
| `e_value`, `strength` | evidence; norm of the pooled effect in standard errors |
| `rivals` | what cannot be told from it, how far it is, which measurement would tell in how many sessions |
| `sessions`, `limits` | every session's amplitude; what the pool finds with 95 % power |
| `gain` | the amplitudes of the first two thirds of the sessions, tried on the later ones |
| `terms` | empirical terms where the catalogue ends: equation, gain on the later sessions, nearest cause |

## In the service

A group's answer is made again, in the background, when one of its sessions is added or changes its state. The newest
60 accepted sessions are pooled, of a unit those since its last service; a stand's group adds up to 60 of the same units
elsewhere. `left_out` counts older ones, `not_pooled` lists sessions without a record. It is shown on the pages of unit,
type and stand, and by [the API](../api.md#diagnosis-and-models).

## Accepted into a model

An engineer accepts an effect for the unit, every unit of a type, or whatever is measured on a stand: on the page or
by `POST /stands/{name}/diagnosis/accept`, and takes it back by `POST /models/{id}/withdraw`.

* Its size is the group's (only a varying effect is estimated in each session). It is subtracted from the readings, and
  its σ and spread τ enter every parameter's uncertainty.
* Of one cause on one sensor the unit's size comes before the type's, and that before the stand's. A cause accepted
  from a single session is estimated in each.
* Stored sessions concerned are recomputed; the revision's page shows changed verdicts and the largest change in each
  unit. Withdrawal is a new revision.
* A learned term is accepted as `empirical-term`, without what a session lacks, such as temperature.

## In the diagnosis of one session

`diagnose(session, history)` pools the session with its unit's earlier ones. An effect that only they together show is
named in it, with the pooled amplitude, if its readings support it: prior odds n + 1 for n earlier sessions, times
p(readings | amplitude of the others) / p(readings | none), at least nine in ten. Below one in twenty it is reported as
ended. Such a finding has `over_sessions`: how many sessions, their e-value, and the probability in this one; it raises
no flag. Blocks of more than 16 sensors are pooled only where records were kept.

Units of twelve sessions, pooled strength 8.2 to 9.5, at most 3.5 in a session (`python -m
benchmarks.study.with_history --groups 53 --seed 1`):

| the twelfth session | measured |
| --- | --- |
| by itself: named or listed | 0.0 % (0.0–6.8) of 53 |
| with eleven earlier ones: named or listed | 88.7 % (77.4–94.7) of 53 |
| the effect ended before it: named all the same | 11.3 % (5.3–22.6) of 53 |
| a unit without an effect: anything named that only several sessions show | 0.0 % (0.0–6.8) of 53 |

From Python: `diagnose_group(sessions, level)`; or `statistics_of(session)` once, then `diagnose_statistics(records,
level, sessions)`, oldest first; without `sessions` no measurement is proposed and no term learned.

## Real recordings

Made by `python -m benchmarks.recorded_groups`; χ² per degree of freedom of a session left out, without and with what
the others show.

* The array of eight triads, three sessions, accelerometers: `warm-up` on the z axes, some with `bias-ramp` as a
  rival: 0.53 → 0.40, 0.36 → 0.24, 1.61 → 1.23.
* Its gyros: nothing; without the second session a cause is named, 3.28 → 3.18.
* Five MPU-9150 of one type, one session each: nothing.

## Limits

Record causes, outliers, jumps, clipping and excess noise belong to their session and are not pooled, nor are
[parameters between sessions](../decisions/residuals-alone.md). Of two similar effects on one stand one may take the
name of both.

Nearest to fail outside the catalogue: odd powers of the input within 4 standard errors of `cubic-nonlinearity`, and
products with temperature that resemble `scale-temperature`; beside one of two effects on one sensor, sums of terms.
"""

SHOWN = 4
"""Rows of the shortened page: names that are right, and names without an effect."""


def page(marks: list[dict[str, Any]], command: str) -> str:
    """The page, from the marks of every group."""
    head = "| figure | target | measured |\n| --- | --- | --- |\n"
    rows = [f"| {a} | {b} | {c} |" for a, b, c in table(marks)]
    return (
        f"{EXPLANATION}\n## How well it does\n\nSimulated groups, drawn at random, their physics written a second time "
        f"(`tests/blind/groups.py`); 95 % intervals after Wilson. Made by `{command}`.\n\n"
        + head
        + "\n".join(rows[:SHOWN])
        + "\n\n"
        + in_full(head + "\n".join(rows[SHOWN:]))
        + "\n"
    )


def table(marks: list[dict[str, Any]]) -> Iterator[tuple[str, str, str]]:
    """Rows: figure, target, measured."""
    part = {name: [m for m in marks if m["part"] == name] for name in PARTS}
    one = part["one"]
    clear = [m for m in one if m["clear"]]
    strong = [m for m in [*one, *part["spread"], *part["since"]] if min(m["pooled"]) >= 8]
    yield (
        "pooled strength ≥ 8, separation ≥ 5, no session above 3.5: named first, right level",
        "≥ 97 %",
        str(rate([m["first"] for m in clear])),
    )
    listed = rate([all(m["listed"]) for m in strong])
    alternatives = fmean([m["alternatives"] for m in strong] or [float("nan")])
    yield (
        "all with pooled strength ≥ 8: named or listed; mean alternatives",
        "≥ 99 %; ≤ 2",
        f"{listed}; {alternatives:.2f}",
    )
    lives = [m["largest"] >= 4.60517 for m in part["life"]]
    yield "without an effect, looked at after each of 100 sessions: ever a name", "≤ 1 %", str(rate(lives))
    none = [bool(m["findings"]) for m in part["none"]]
    yield "without an effect, half of them with misstated noise, 10 to 18 sessions: a name", "≤ 1 %", str(rate(none))
    first = [m["first_strength"] for m in one if m["first_strength"] is not None]
    yield (
        "pooled strength at the session that first shows it, median",
        "≤ 6.5",
        f"{median(first):.1f}" if first else "–",
    )
    for name, words in (("one", "τ = 0"), ("spread", "τ > 0")):
        pulls = [abs(p) <= 2 for m in part[name] for p in m["pulls"]]
        yield f"amplitude within two of its sigma, {words}", "93–97 %", str(rate(pulls))
    since = [m["forms"][0] == "since" for m in part["since"] if m["named"][0]]
    yield "effect that began later: its beginning found, where it is named", "–", str(rate(since))
    two = [all(m["listed"]) for m in part["two"]]
    yield "two effects of pooled strength ≥ 8: both named or listed", "–", str(rate(two))
    wrong = [all(m["listed"]) for m in part["misstated"]]
    yield "the same with one, stated noise wrong by a factor of 0.4 to 2: named or listed", "–", str(rate(wrong))
    outside = part["outside"]
    said = rate([m["unexplained"] for m in outside])
    named = rate([bool(m["findings"]) for m in outside])
    yield (
        "outside the catalogue, strength 6 in each session: `unexplained` answered; a wrong name",
        "–",
        f"{said}; {named}",
    )
    yield from terms(outside, part["none"])
    yield from hidden(part["grammar"], one)
    shares = [m["share"] for m in marks if m.get("share")]
    yield (
        "time to add a session, as a share of its diagnosis, median",
        "< 20 %",
        f"{100 * median(shares):.0f} %" if shares else "–",
    )


def terms(outside: list[dict[str, Any]], none: list[dict[str, Any]]) -> Iterator[tuple[str, str, str]]:
    """Rows of the learned terms."""
    judged = [m for m in outside if m.get("correlation") is not None]
    yield (
        "outside the catalogue: learned prediction against the truth, correlation ≥ 0.95",
        "–",
        str(rate([m["correlation"] >= 0.95 for m in judged])),
    )
    yield (
        "the same: at least 80 % of the excess χ² of left-out sessions removed",
        "–",
        str(rate([m["explained"] >= 0.8 for m in judged])),
    )
    yield "sound groups: any term learned", "≤ 1 %", str(rate([bool(m["terms"]) for m in none]))


def hidden(outside: list[dict[str, Any]], one: list[dict[str, Any]]) -> Iterator[tuple[str, str, str]]:
    """Rows of effects of a hidden grammar, and what the doubt about them costs effects that the catalogue has."""
    sure = str(rate([m["sure"] for m in outside]))
    far = str(rate([m["sure"] for m in outside if min(m["separations"]) >= 3]))
    yield "hidden grammar, strength 6 in each of ten sessions: a name without `unexplained`", "≤ 2 %", sure
    yield "the same, 3 or more standard errors from every cause of the catalogue", "≤ 2 %", far
    named, crowd = rate([bool(m["findings"]) for m in outside]), rate([m["crowd"] > 1 for m in outside])
    yield "the same: any name; two or more names on one sensor", "–", f"{named}; {crowd}"
    back, doubted = rate([m["unexplained"] for m in one]), rate([m["doubted"] for m in one])
    yield "one effect of the catalogue: `unexplained` answered; among its alternatives", "–", f"{back}; {doubted}"


PARTS = ("one", "spread", "since", "two", "none", "misstated", "outside", "life", "grammar")
