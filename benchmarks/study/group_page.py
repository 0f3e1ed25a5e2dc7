"""The page of evidence of many sessions: explanation, and the table of the study."""

from collections.abc import Iterator
from statistics import fmean, median
from typing import Any

from benchmarks.study.rates import rate

EXPLANATION = """# Evidence of many sessions

A session sees an effect from about five standard errors. Thirty sessions of a unit, on a stand or of a type see one of
strength 1 in each as plainly. `diagnose_group(sessions, level)` adds them up and says what they share, with the rules
that hold for a session: a name is given only to what fits, and what cannot be told apart is listed together.

## What is kept of a session

`statistics_of(session)` makes a record of some hundred kilobytes: for every cause that can last, at every place and in
every shape, its *score* U (how much of it the residuals hold) and its *information* F (how much they could hold), with
the information that any two share. Clipped channels, slips of the record and lone wrong readings are put right first.
A session that scatters otherwise than its file states enters with the scatter that it shows. The amplitude that fits
a whole group is â = (ΣF)⁻¹ΣU, its covariance (ΣF)⁻¹: no reading is needed any more.

## Whose it is

| level | effects | held against |
| --- | --- | --- |
| unit | a sensor's or its environment's, on one unit | the same on every unit of the type, a cause of the stand |
| type | the same of the sensor of one name in every unit, or of every sensor of a kind | one unit's, the stand's |
| stand | of stand and fixture, over all units; a sensor cause that every sensor measured there shares | the units' |

All levels are weighed on the same sessions. Two that fit alike are listed as rivals: only the same units on another
stand tell them apart.

## When a name is given

The group is looked at after every upload, for years. So evidence is counted in *e-values*: bets that gain nothing on
average where there is nothing, however often one looks. The mean over all causes, places, shapes and three forms (the
same in every session; there, but different every time; since some session) reaches 100 in at most one group of a
hundred without an effect, ever. A name needs that, must hold without the session that shows it most, must make sessions
that took no part in its amplitude likelier, and must leave nothing but noise: where waves of β are left on the same
sensor, or common to all, the name is taken back and the group is *unexplained*.

A name also says that the cause fits, not that it is the nearest of the catalogue. So at its place it is weighed against
a library of empirical terms, some two hundred products of what a session knows of each reading (input, its size, sign
and powers, what is across it, temperature, its square, its rate, what follows it late, time, waves of β, the row
before), less those that a cause of the catalogue describes too:

* Where the terms are at least 20 times as likely, or are as sure beside the name as a name must be, the name is taken
  back: *unexplained*, with the equation that was learned. What a name describes nearly, to 5 % of what it explains,
  stays its own.
* Where they are within 200 to 1, `unexplained` stands among the alternatives of the name. So it does where the sessions
  have the name in different sizes (the form `varying`, or Cochran's test at 1 %): a cause is one constant, and what is
  in no catalogue looks so too.
* Every name beyond the first on one sensor pays as much as an independent misfortune is rare, ln 100.
* A place whose names were taken back is left free in every session, and the search is made again: what is named
  elsewhere holds whatever that place does.

Names are only taken back in this way, so that a group without an effect keeps its bound. It takes the readings: what
is kept of a session holds the scores of the catalogue, and those of the library would make it five times as large.
Without sessions `diagnose_statistics` weighs names by waves of β and by prediction alone, and `unexplained` stands
among the alternatives of each.

## What an answer holds

| field | meaning |
| --- | --- |
| `amplitude`, `sigma`, `spread` | mean over sessions in SI, and τ between them (random effects) |
| `form`, `since` | `same`, `varying` or `since` a date |
| `e_value`, `strength` | evidence; norm of the pooled effect in standard errors |
| `rivals` | what cannot be told from it, how far it is, which measurement would tell and how many sessions of it |
| `sessions` | every session's own amplitude: a forest plot |
| `limits` | what the pool finds with 95 % power, and what one session would |
| `gain` | the amplitudes fixed on the first two thirds of the sessions, tried on the later ones |
| `terms` | empirical terms, learned where the catalogue ends: equation, gain on the later sessions, nearest cause |

## In the service

* Beside the diagnosis of a session, in the same process, its record is made and kept: once, since it needs nothing of
  other sessions. Records of sessions older than that are made with the first answer of their group. One that fails is
  kept with its reason, and the next version of the program tries again.
* A group's answer is made again when one of its sessions comes, gets its record, or changes its state: a session that
  is withdrawn, questioned or superseded leaves the pool, and one that is accepted comes back. A digest of the
  sessions says whether a stored answer still holds; one that does not is never given out.
* The newest 60 accepted sessions are pooled, of a unit those since its last service. To those of a stand come up to
  60 of the same units elsewhere, from before its last one. `left_out` counts the older ones; `not_pooled` lists
  sessions without a record, with the reason.
* The pages of a unit, a type and a stand show it: every session's own amplitude beside the pooled one, what all of them
  leave without the effect and with it, what naming it gains on later sessions, what would tell it from its rivals, and
  the limits of the pool beside those of one session. The fleet page says in a line what was found anywhere.
  `GET /units/{serial}/diagnosis`, `/unit-types/{name}/diagnosis` and `/stands/{name}/diagnosis` hand it out:
  [the API](../api.md#diagnosis-and-models).

## Accepted into a model

An engineer accepts an effect for whom it is found: the unit, every unit of a type, or whatever is measured on a stand.
On the page with a button, by `POST …/diagnosis/accept`, or

```
imu-health models accept stand ODG-1 beta-eccentricity --by "K. Ito" --why "encoder looked at"
imu-health models show 7
imu-health models withdraw 7 --by "K. Ito" --why "encoder aligned on 3 May"
```

* Its size is the group's, and no session fits it again: fitted freely, an effect below the noise would cost each
  session more than it is worth. What it adds is taken out of the readings, and what the group does not know of it (its
  σ and the spread τ) is in every parameter's uncertainty. Only of an effect that differs every time each session has a
  say.
* What began at a date is not in the sessions before it.
* Of one cause on one sensor the size found nearest to it counts: the unit's before the type's before the stand's. A
  cause that was accepted from a single session is fitted in each, as it always was.
* Every stored session that it concerns is computed again, unit by unit, in the processes beside the requests. The page
  of the revision says how far that is, which sessions have another verdict since, and what moved furthest in each unit;
  all of it stays on record. Nothing is overwritten.
* It is withdrawn by a revision of its own, and goes out of every session again.
* A learned term is accepted alike, under the name `empirical-term`: its equation stands on the page of the revision,
  and what of it a session lacks, as a temperature, is left out there. Of one place one term counts.

## In the diagnosis of one session

`diagnose(session, history)` pools the session with its unit's earlier ones, by the rules of a group; names are held
against the library by the readings of the session and its history, also where records of earlier ones are pooled. What
they show together and the session by itself does not name is named in it too, with the amplitude of all of them, where
the session's own readings bear out that it is there: n earlier sessions that have it make the odds n + 1 beforehand,
the readings multiply them by p(readings | amplitude of the others) / p(readings | none), and a name needs nine in ten.
Then it is taken out of every session at the amplitude that the others found, and the search is made anew: what is left
is the session's own, and the gain rests on an amplitude that its readings had no part in. Below one in twenty the
diagnosis says that it has ended, and the history, whose parameters had absorbed it, is freed of it. A finding of this
kind has `over_sessions`: how many speak of it, their e-value, and the probability that this session has it.

The service pools what it kept of up to 60 earlier sessions since the unit's last service. Such a finding raises no flag
of the session's: the group has one. Blocks of more than 16 sensors are pooled with their history only where records
were kept.

Units of twelve sessions with an effect of pooled strength 8.2 to 9.5, at most 3.5 in a session, made by
`python -m benchmarks.study.with_history --groups 53 --seed 1`:

| the twelfth session | measured |
| --- | --- |
| by itself: named or listed | 0.0 % (0.0–6.8) of 53 |
| with eleven earlier ones: named or listed | 88.7 % (77.4–94.7) of 53 |
| the same, where its own strength is 2 or more | 90.7 % (78.4–96.3) of 43 |
| the effect ended before it: named all the same | 11.3 % (5.3–22.6) of 53 |
| a unit without an effect: anything named that only several sessions show | 0.0 % (0.0–6.8) of 53 |

What is missed are pools that do not reach their threshold yet, and sessions whose noise speaks against the effect. One
that has just ended outlasts its end by a session in one case of nine: at strength 3 no reading tells better.

From Python: `statistics_of(session)` is the record, with `to_dict` and `from_dict` (`imu-session-statistics/2`);
`diagnose_statistics(records, level, sessions)` pools records, oldest first. Without `sessions` no measurement is
proposed, no term learned and no name sure. `diagnose_group(sessions, level)` is both at once.

## Real recordings

Made by `python -m benchmarks.recorded_groups`. A session left out is calibrated without and with what the others show,
at the size that they found.

* The array of eight triads, three sessions, accelerometers: `warm-up` on the z axes, some with `bias-ramp` as a rival;
  the same each time in A1z, since the second session in A5z, different every time in A2z, A3z, A4z, A6z, A8z. χ² per
  degree of freedom of the session left out: 0.53 → 0.40, 0.36 → 0.24, 1.61 → 1.23.
* Its gyros: nothing. Where the second session is left out the other two name a cause, and its χ² goes from 3.28
  to 3.18.
* Five MPU-9150 of one type, one session each, accelerometers and gyros: nothing.

A board that is switched on before each session warms, and its z axes say so each time: what two sessions teach takes a
quarter off the misfit of the third. Five units measured once each share nothing that five sessions could show.

What is not pooled: record causes, outliers, jumps, clipping and excess noise belong to their session. How parameters
moved between sessions is no evidence: [residuals alone are](../decisions/residuals-alone.md).

Every figure below is at its target, or its interval holds it. An amplitude that differs from session to session is
known a little less well than its sigma says: ten to eighteen sessions tell little of how much it differs. Of two
effects on one stand that look alike, one may take the name of both.

Effects of one sensor drawn from a hidden grammar of products (`tests/blind/effects_grammar.py`), strength 6 in each of
ten sessions; made by `python -m benchmarks.study.groups --groups 26 --seed 31 --part grammar`. A name and nothing said
to be unexplained: 0.0 % (0.0–6.9) of 52. In 48 other such groups it was 29 before names were weighed against the
library. In 228 others it was 7 after that: five powers of the input nearer than 4 standard errors to
`cubic-nonlinearity` on the pool, a product of scale and temperature cubed that varies as `scale-temperature` with the
range of temperature, and one whose `thermal-lag` a single session of a wide range carries. All seven are doubted now.
"""


def page(marks: list[dict[str, Any]], command: str) -> str:
    """The page, from the marks of every group."""
    rows = "\n".join(f"| {a} | {b} | {c} |" for a, b, c in table(marks))
    return (
        f"{EXPLANATION}\n## How well it does\n\nSimulated groups, drawn at random, their physics written a second time "
        f"(`tests/blind/groups.py`); 95 % intervals after Wilson. Made by `{command}`.\n\n"
        f"| figure | target | measured |\n| --- | --- | --- |\n{rows}\n"
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
    yield "effect that began later: said to have begun, where it is named", "–", str(rate(since))
    two = [all(m["listed"]) for m in part["two"]]
    yield "two effects of pooled strength ≥ 8: both named or listed", "–", str(rate(two))
    wrong = [all(m["listed"]) for m in part["misstated"]]
    yield "the same with one, stated noise wrong by a factor of 0.4 to 2: named or listed", "–", str(rate(wrong))
    outside = part["outside"]
    said = rate([m["unexplained"] for m in outside])
    named = rate([bool(m["findings"]) for m in outside])
    yield "outside the catalogue, strength 6 in each session: unexplained said; a wrong name", "–", f"{said}; {named}"
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
    yield "hidden grammar, strength 6 in each of ten sessions: a name and nothing said to be unexplained", "≤ 2 %", sure
    yield "the same, 3 or more standard errors from every cause of the catalogue", "≤ 2 %", far
    named, crowd = rate([bool(m["findings"]) for m in outside]), rate([m["crowd"] > 1 for m in outside])
    yield "the same: any name; two or more names on one sensor", "–", f"{named}; {crowd}"
    back, doubted = rate([m["unexplained"] for m in one]), rate([m["doubted"] for m in one])
    yield "one effect of the catalogue: unexplained said; unexplained among its alternatives", "–", f"{back}; {doubted}"


PARTS = ("one", "spread", "since", "two", "none", "misstated", "outside", "life", "grammar")
