"""Dates of histories whose errors have tails or none, by the forecast and by rivals that weigh sessions by them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.backtest.forecasts import DATED, LATE, SINCE, Reached, mixed
from benchmarks.backtest.histories import STEP, History
from benchmarks.backtest.units import NOW, learned, track
from benchmarks.backtest.worlds import World
from benchmarks.tails.reweighting import reweighted
from estimator.health.detection import LEVEL, detect
from estimator.health.fits import Readings
from estimator.health.forecast import earliest, staying
from estimator.health.pooled import Prior
from estimator.health.posterior import Draws, draw
from estimator.health.prognosis import alternatives, felt, prognosis, swing
from estimator.health.shapes import DRIFTS, courses


@dataclass(frozen=True)
class Level:
    """Stated level of a parameter, T."""

    error: float
    sigma: float


@dataclass(frozen=True)
class Told:
    """One history: its dates, and its levels, by the forecast and by the rivals."""

    dates: Reached
    levels: tuple[Level, ...]


def told(world: World, types: int, rng: np.random.Generator) -> list[Told]:
    """Results for types as in the back-test: three units of each kind, and more of the drift that begins some day."""
    found, late = list[Told](), world.planned(DATED, since=SINCE)
    for _ in range(types):
        units = [mixed(world, i, rng) for i in range(3 * len(world.kinds))]
        prior = learned(units)
        ones = [(unit.parameters[0], False) for unit in units]
        ones += [(world.made(world.late, late, rng), True) for _ in range(LATE)]
        found += [_told(one, prior, is_more=is_more) for one, is_more in ones if one.passed > 0]
    return found


def _told(one: History, prior: Prior, *, is_more: bool) -> Told:
    own = prognosis([track(one)], [prior], NOW).outlooks[0]
    truth = float(one.truth[round(float(one.time[-1]) / STEP)])
    early, levels = [own.reach_90], [Level(own.level - truth, own.level_sigma)]
    for is_missing in (False, True):
        date, draws = _by_rival(one, prior, is_missing=is_missing)
        early.append(date)
        levels.append(_level(draws, truth))
    since = int(np.sum(one.time >= one.onset))
    return Told(Reached(one.kind, tuple(early), one.passed, bool(own.changes), since, is_more), tuple(levels))


def _by_rival(one: History, prior: Prior, *, is_missing: bool) -> tuple[float, Draws]:
    """Reach 90, years, and the draws behind it; all but the weights of the sessions is the estimator's."""
    n, rng = len(one.time), np.random.default_rng(0)
    base = Readings(one.time, one.value[:, None], one.sigma[:, None], np.ones((n, 1)), np.ones(1), prior.tails)
    found = detect(base, prior.usual_walk, np.full(n, np.inf), one.temperature, LEVEL)
    family = courses(found.readings.time, felt(found.warmth, one.temperature))
    given = [(reweighted(way, family, prior, is_missing=is_missing), log) for way, log in alternatives(found, prior)]
    draws = draw(given, family, prior, rng)
    stays = staying(draws, prior, swing(found.warmth, draws, one.temperature), rng)
    return earliest(draws, stays, drifts=any(change.kind in DRIFTS for change in found.changes)), draws


def _level(draws: Draws, truth: float) -> Level:
    level = draws.level[:, 0]
    middle = float(draws.mean(level))
    return Level(middle - truth, float(np.sqrt(draws.mean((level - middle) ** 2))))


def tailed(world: World, freedom: float) -> World:
    """The generator with errors of so many degrees of freedom."""
    return replace(world, plan=replace(world.plan, freedom=freedom))


def surprised(found: Sequence[Told], whose: int) -> list[bool]:
    """Whether each level is further out than twice its stated uncertainty."""
    return [abs(one.levels[whose].error) > 2 * one.levels[whose].sigma for one in found]


def missed(found: Sequence[Told], whose: int) -> float:
    """Median error of the levels, T."""
    return float(np.median([abs(one.levels[whose].error) for one in found]))
