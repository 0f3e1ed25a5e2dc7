"""A unit's outlook: what changed in every parameter, where each goes, and the risk that any is out of tolerance.

An axis deviates in two directions; both are one history with one time of change, its tolerance is a disc.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.health.detection import LEVEL, Change, Detected, detect, warmed
from estimator.health.fits import PART_KINDS, PART_SIZES, Readings, fits
from estimator.health.forecast import AHEAD, MEDIAN, Future, earliest, future, passed, reach, staying, together
from estimator.health.pooled import Evidence, Prior
from estimator.health.posterior import Draws, draw
from estimator.health.shapes import DRIFTS, Kind, courses
from estimator.health.tails import log_tails
from estimator.health.warmth import Warmth, centred, shows_temperature
from estimator.session import Array
from estimator.significance import single_level

UNLIKELY = 30.0
"""Log odds against what is ruled out."""


def alternatives(detected: Detected, prior: Prior) -> list[tuple[Readings, float]]:
    """The readings as they are, and with the jumps that are over acting, each with the log of what speaks for it.

    A walk shows jumps too, and what is left between them would be taken for a drift. Jumps act with any size a in the
    likelihood; beside it speaks the rate of jumps in their gaps, and Π exp(−a²/2s²)/s over the components.
    """
    if not detected.over:
        return [(detected.readings, 0.0)]
    time, is_jump, log = detected.readings.time, PART_KINDS == Kind.JUMP, 0.0
    size = PART_SIZES[is_jump]
    for change in detected.over:
        likely = -(change.size**2).sum() / (2 * size**2) - len(change.size) * np.log(size)
        expected = prior.rate[is_jump] * (time[change.gap] - time[change.gap - 1])
        log += float(np.logaddexp.reduce(np.log(np.maximum(expected, 1e-300)) + likely))
    return [(detected.readings, 0.0), (detected.without_jumps(), log)]


def felt(warmth: Warmth | None, temperature: Array) -> Array:
    """(n,) °C about their mean at the sessions; zero where the temperature was found and acts whatever else does."""
    return np.zeros(len(temperature)) if warmth is not None and warmth.is_found else centred(temperature)


def swing(warmth: Warmth | None, draws: Draws, temperature: Array) -> Array:
    """(N, 1) T that the span of temperatures (n,) °C takes off the tolerance of every draw, on either side."""
    if warmth is not None and warmth.is_found:
        return np.full((len(draws.weight), 1), warmth.swing(temperature))
    away = np.abs(centred(temperature)).max()
    return np.asarray(np.linalg.norm(draws.slope, axis=1, keepdims=True) * away)


def given_temperature(logs: Array, warmth: Warmth | None) -> Array:
    """(Q, P) log evidence of a history in which the temperature, if it was found, acts whatever else does: nothing else
    is then temperature alone, of each size by how likely the coefficient is under its law."""
    if warmth is None or not warmth.is_found:
        return logs
    is_warmth, logs = PART_KINDS == Kind.WARMTH, logs.copy()
    spread = PART_SIZES[is_warmth, None] ** 2 + warmth.sigma**2
    alike = -0.5 * (np.log(spread) + warmth.coefficient**2 / spread).sum(axis=1)
    logs[:, is_warmth] = logs[:, :1] + alike - alike.max()
    logs[:, 0] -= UNLIKELY
    return logs


RECENT = 60
"""Sessions, the newest, that a history is made of; older ones hardly tell of what goes on now."""
GOES_ON = (*DRIFTS, Kind.SETTLING)
"""Kinds of change of which one acts where a drift is found: so the trend agrees with the change that is shown."""
KNOWN = 0.5
"""A level is known well enough for a forecast while its sigma is below this part of the tolerance: U = 2·u below T, as
the decision rule asks."""


@dataclass(frozen=True, eq=False)
class Track:
    """One parameter of one sensor since the last break, the reference session included."""

    time: Array
    """(n,) years, increasing."""
    change: Array
    """(n, k) deviation from the recorded reference, SI or relative; k = 1, for an axis 2 along its reference's tangents
    (rad)."""
    sigma: Array
    """(n, k) standard uncertainty that each session brings, unit of the change; of the reference session its own."""
    tolerance: float
    """Unit of the change."""
    dof: Array | None = None
    """(n,) degrees of freedom of each uncertainty; None, or infinite, where the noise is known."""
    temperature: Array | None = None
    """(n,) °C; NaN of a session without one."""


@dataclass(frozen=True, eq=False)
class Outlook:
    """The forecast of one track; SI a year, years."""

    level: float
    """Level along `direction`."""
    level_sigma: float
    rate: float
    """Rate of the drift in force: its mean over everything that the history and the type allow."""
    rate_sigma: float
    p_value: float
    """Chance of a change as evident, at any time and of any kind, where nothing happens."""
    changes: tuple[Change, ...]
    """Changes that were found; sizes in tolerances, gaps counted in the track's sessions."""
    warmth: Warmth | None
    chance: Array
    """(h,) probability of having reached the tolerance by `AHEAD` after the track's last session."""
    reach_50: float
    """Years after the last session by which one that is within its tolerance now has reached it as likely as not;
    infinite beyond the horizon."""
    reach_90: float
    """Years before which the tolerance is reached with 10 % probability, and with at most 20 % if there is a drift;
    with 10 % for a drift that was found.
    """
    is_known: bool
    """Whether the level is known well enough for a forecast."""
    direction: Array
    """(k,) unit vector that level and rate are along."""
    fan: Future
    """Forecast at the requested dates."""

    @property
    def steps(self) -> tuple[int, ...]:
        """Places in the track's sessions at which the value was first seen after a sudden change."""
        return tuple(sorted(change.gap for change in self.changes if change.kind is Kind.JUMP))

    @property
    def drift(self) -> Change | None:
        """The drift or the aging that was found."""
        return next((change for change in self.changes if change.kind in DRIFTS), None)


@dataclass(frozen=True, eq=False)
class Prognosis:
    """All tracks of a unit."""

    outlooks: tuple[Outlook, ...]
    risk: Array
    """(h,) probability that any known parameter has reached its tolerance by `AHEAD` after the latest session."""

    def chances(self, tracks: Sequence[Track]) -> Array:
        """(B, h) chances of every track of this prognosis; 0 where its level is not known well enough."""
        chances = _chances(tracks, self.outlooks)
        return np.where([[outlook.is_known] for outlook in self.outlooks], chances, 0.0)


def evidence(track: Track) -> Evidence:
    """The contribution of a track to its type, independent of what else is known of the type."""
    readings, (dof, temperature) = _readings(track), _conditions(track)
    warmth = None
    if shows_temperature(temperature):
        start = warmed(readings, 0.0, dof, temperature, LEVEL)
        readings, warmth = start.readings, start.warmth
    fitted = fits(readings, courses(readings.time, felt(warmth, temperature)))
    logs = fitted.log_evidence()
    return Evidence(fitted.span, given_temperature(logs, warmth), log_tails(readings, fitted.family, logs))


def prognosis(tracks: Sequence[Track], priors: Sequence[Prior], ahead: Array) -> Prognosis:
    """The outlook of every track, and of the unit as a whole.

    Parameters
    ----------
    tracks : at least one, each with two sessions or more.
    priors : of every track's parameter in its type.
    ahead : years after the last session, increasing, at which fans are wanted.
    """
    level = single_level(LEVEL, len(tracks))
    outlooks = tuple(_outlook(t, p, ahead, (i, level)) for i, (t, p) in enumerate(zip(tracks, priors, strict=True)))
    return Prognosis(outlooks, _risk(tracks, outlooks))


def _readings(track: Track) -> Readings:
    time, unit = track.time[-RECENT:], track.tolerance
    n = len(time)
    return Readings(
        time - time[0], track.change[-RECENT:] / unit, track.sigma[-RECENT:] / unit, np.ones((n, 1)), np.ones(1)
    )


def _conditions(track: Track) -> tuple[Array, Array]:
    """(n,) degrees of freedom, and (n,) °C, of the sessions that are looked at."""
    n = len(track.time)
    dof = np.full(n, np.inf) if track.dof is None else track.dof
    warm = np.full(n, np.nan) if track.temperature is None else track.temperature
    return dof[-RECENT:], warm[-RECENT:]


def direction(track: Track) -> Array:
    """(k,) unit vector, dimensionless: of an axis where it points from its reference, the mean of the last three
    sessions by their precision; 1 of a number."""
    if track.change.shape[1] == 1:
        return np.ones(1)
    weight = track.sigma[-3:].max(axis=1, keepdims=True) ** -2.0
    mean = (weight * track.change[-3:]).sum(axis=0)
    length = float(np.hypot(*mean))
    return mean / length if length > 0 else np.array([1.0, 0.0])


def _outlook(track: Track, prior: Prior, ahead: Array, number_and_level: tuple[int, float]) -> Outlook:
    """The outlook of a track; ``number_and_level``: its number, which seeds the draws, and its level of detection."""
    number, level = number_and_level
    rng = np.random.default_rng(number)
    readings = replace(_readings(track), tails=prior.tails)
    dof, temperature = _conditions(track)
    detected = detect(readings, prior.usual_walk, dof, temperature, level)
    family = courses(readings.time, felt(detected.warmth, temperature))
    given = GOES_ON if any(change.kind in DRIFTS for change in detected.changes) else ()
    draws = draw(alternatives(detected, prior), family, prior, rng, given)
    stays = staying(draws, prior, swing(detected.warmth, draws, temperature), rng)
    chance = passed(draws.weight, stays)
    along = direction(track)
    middle, sigma = _moments(draws, along)
    rate, rate_sigma = _rate(draws, along)
    skipped = max(len(track.time) - RECENT, 0)
    return Outlook(
        level=middle * track.tolerance,
        level_sigma=sigma * track.tolerance,
        rate=rate * track.tolerance,
        rate_sigma=rate_sigma * track.tolerance,
        p_value=detected.p_value,
        changes=tuple(replace(change, gap=change.gap + skipped) for change in detected.changes),
        warmth=detected.warmth,
        chance=chance,
        reach_50=_median(chance),
        reach_90=earliest(draws, stays, drifts=any(change.kind in DRIFTS for change in detected.changes)),
        is_known=sigma < KNOWN,
        direction=along,
        fan=future(draws, prior, ahead, rng),
    )


def _median(chance: Array) -> float:
    """Years by which it is reached as likely as not by one that is within now; 0 where it is out already as likely as
    not."""
    now = float(chance[0])
    return float(reach(chance[None], now + MEDIAN * (1 - now))[0]) if now < MEDIAN else 0.0


def _moments(draws: Draws, unit: Array) -> tuple[float, float]:
    """Mean and one sigma of the level along a direction, T."""
    along = draws.level @ unit
    middle = float(draws.mean(along))
    return middle, float(np.sqrt(draws.mean((along - middle) ** 2)))


def _rate(draws: Draws, along: Array) -> tuple[float, float]:
    """Drift in force along a direction with one sigma, T a year, over all that the history may be: few sessions after a
    break leave it to what the type does."""
    rates = (draws.rate + draws.aging * draws.slowed()[:, None]) @ along
    middle = float(draws.mean(rates))
    return middle, float(np.sqrt(draws.mean((rates - middle) ** 2)))


def _chances(tracks: Sequence[Track], outlooks: Sequence[Outlook]) -> Array:
    """(B, h) probability of every parameter of being out by `AHEAD` after the latest session of all tracks."""
    latest = max(float(track.time[-1]) for track in tracks)
    rows = [
        np.interp(AHEAD + latest - float(track.time[-1]), AHEAD, outlook.chance)
        for track, outlook in zip(tracks, outlooks, strict=True)
    ]
    return np.stack(rows)


def _risk(tracks: Sequence[Track], outlooks: Sequence[Outlook]) -> Array:
    """(h,) probability that any known parameter is out by `AHEAD` after the latest session of all tracks."""
    known = np.array([outlook.is_known for outlook in outlooks])
    return together(_chances(tracks, outlooks)[known]) if known.any() else np.zeros_like(AHEAD)
