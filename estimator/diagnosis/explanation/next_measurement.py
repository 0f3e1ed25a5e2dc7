"""Measurements that could distinguish causes: each proposal gives words and the session it would lead to.

A proposal plans a session of the same block on the same stand: more positions, another order, a temperature cycle, the
other run, another elevation, a longer session. The planned session is a `Baseline` without readings, at the fitted
parameters and the noise of the session at hand.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import planned_on_stand
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

Proposal = Callable[[Baseline], Iterator[tuple[str, Baseline]]]


def schedule(baseline: Baseline, beta: Array, flipped: Array, **changes: object) -> Baseline:
    """The planned session with rows ``beta`` (R,), rad, and ``flipped`` (R,), spaced in time as before."""
    session = baseline.session
    rows = len(beta)
    period = 120.0
    if session.time is not None and len(session.time) > 1:
        period = max(float(np.median(np.diff(session.time))), 1e-3)
    temperature = None if session.temperature is None else np.full(rows, float(session.temperature.mean()))
    planned = replace(
        session,
        beta=beta,
        flipped=flipped,
        readings=np.zeros((rows, len(session.sensors))),
        standard_errors=np.zeros((rows, len(session.sensors))),
        time=None if session.time is None else period * np.arange(rows),
        temperature=temperature,
        position=None,
    )
    return planned_on_stand(replace(planned, **changes), baseline)  # type: ignore[arg-type]  # changes name fields


def runs(session: CalibrationSession) -> list[bool]:
    """The runs the session has, in order."""
    assert session.flipped is not None
    return [bool(f) for f in dict.fromkeys(session.flipped.tolist())]


def steps(session: CalibrationSession) -> int:
    """Number of different β settings."""
    assert session.beta is not None
    return len(np.unique(np.round(np.mod(session.beta, 2 * np.pi), 6)))


def full_turns(positions: int, which: list[bool]) -> tuple[Array, Array]:
    """β (R,), rad, in equal steps over a turn for each run, and flipped (R,)."""
    turn = 2 * np.pi * np.arange(positions) / positions
    return np.tile(turn, len(which)), np.repeat(np.array(which), positions)


def other_run(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Add the flipped (direct) run."""
    session = baseline.session
    if len(runs(session)) == 1:
        name = "direct" if runs(session)[0] else "flipped"
        beta, flipped = full_turns(max(steps(session), 12), [False, True])
        yield f"add the {name} run at the same positions", schedule(baseline, beta, flipped)


def repeat_reversed(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Go back through the same positions, so that time and position part."""
    session = baseline.session
    assert session.beta is not None
    assert session.flipped is not None
    beta = np.concatenate([session.beta, session.beta[::-1]])
    flipped = np.concatenate([session.flipped, session.flipped[::-1]])
    yield "repeat all positions in the reverse order, ending at the first", schedule(baseline, beta, flipped)


def mixed_order(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Visit the positions in a scattered order (golden-ratio steps), twice."""
    session = baseline.session
    assert session.beta is not None
    assert session.flipped is not None
    order = np.concatenate(
        [np.argsort((np.arange(len(session.beta)) * ratio) % 1.0) for ratio in (0.618034, 0.4142136)]
    )
    yield (
        "visit the same positions twice in a scattered order",
        schedule(baseline, session.beta[order], session.flipped[order]),
    )


def more_positions(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """More β steps in both runs."""
    for factor in (2, 4):
        positions = max(steps(baseline.session), 12) * factor
        beta, flipped = full_turns(positions, [False, True])
        yield f"measure {positions} equal steps of β in both runs", schedule(baseline, beta, flipped)


def temperature_cycle(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Cycle the temperature against time and position."""
    session = baseline.session
    assert session.beta is not None
    assert session.flipped is not None
    rows = 2 * len(session.beta)
    mean = 20.0 if session.temperature is None else float(session.temperature.mean())
    span = 5.0 if session.temperature is None else max(float(np.ptp(session.temperature)), 5.0)
    cycle = mean + span / 2 * np.sin(2 * np.pi * 2.7 * np.arange(rows) / rows)
    beta, flipped = np.tile(session.beta, 2), np.tile(session.flipped, 2)
    planned = schedule(baseline, beta, flipped, temperature=cycle, time=120.0 * np.arange(rows))
    yield f"repeat the session while the temperature is cycled by {span:.0f} °C, almost three times", planned


def other_elevation(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Set the head to another elevation."""
    session = baseline.session
    assert session.stand is not None
    positions = max(steps(session), 24)
    beta, flipped = full_turns(positions, [False, True])
    for degrees in (20.0, 60.0):
        stand = replace(session.stand, alpha=np.radians(degrees), chi=np.radians(degrees))
        words = f"repeat with the head at {degrees:.0f}°, {positions} positions in both runs"
        yield words, schedule(baseline, beta, flipped, stand=stand)


def repeated(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Repeat and average: noise falls with the root of the number, that of a zero which does not repeat too.

    Longer readings would not do: a zero that differs from position to position stays what it is while it is read.
    """
    session = baseline.session
    assert session.beta is not None
    assert session.flipped is not None
    for times in (4, 16, 64):
        planned = schedule(baseline, session.beta, session.flipped)
        yield f"repeat the session {times} times over", replace(planned, variance=planned.variance / times)


def _on_stand(proposal: Proposal) -> Proposal:
    """The proposal, made only for sessions on a stand."""

    def guarded(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
        if baseline.session.programme == TWO_AXIS_STAND:
            yield from proposal(baseline)

    return guarded


PROPOSALS: tuple[Proposal, ...] = tuple(
    _on_stand(p)
    for p in (
        other_run,
        repeat_reversed,
        mixed_order,
        more_positions,
        temperature_cycle,
        other_elevation,
        repeated,
    )
)
"""In the order in which a technician would rather do them."""
