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
from estimator.message import say
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

PERIOD = 120.0
"""s from row to row where the session does not record its times: a usual dwell with the turn to it."""

FINE = 12
"""β steps a turn that a proposal makes at least: the 30° steps of a usual programme."""

REPEATS = 4
"""Times that anybody would repeat a session: what needs more, the stand cannot separate."""

Proposal = Callable[[Baseline], Iterator[tuple[str, Baseline]]]


def proposals(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Every proposal for a session on a stand, in the order in which a technician would rather make them."""
    yield from other_schedules(baseline)
    if baseline.session.programme == TWO_AXIS_STAND:
        yield from repeated(baseline)


def other_schedules(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """The proposals that measure differently, and not merely more often."""
    if baseline.session.programme == TWO_AXIS_STAND:
        for proposal in PROPOSALS:
            yield from proposal(baseline)


def schedule(session: CalibrationSession, beta: Array, flipped: Array) -> CalibrationSession:
    """The planned session with rows ``beta`` (R,), rad, and ``flipped`` (R,), spaced in time as before.

    Its vibration is not planned.
    """
    rows, period = len(beta), PERIOD
    if session.time is not None and len(session.time) > 1:
        period = max(float(np.median(np.diff(session.time))), 1e-3)
    nothing = np.zeros((rows, len(session.sensors)))
    return replace(
        session,
        beta=beta,
        flipped=flipped,
        readings=nothing,
        standard_errors=nothing,
        time=None if session.time is None else period * np.arange(rows),
        temperature=None if session.temperature is None else np.full(rows, float(session.temperature.mean())),
        vibration=None,
        tilt_error=None,
        position=None,
    )


def rows_of(session: CalibrationSession) -> tuple[Array, Array]:
    """β (R,), rad, and flipped (R,) of a session on a stand."""
    assert session.beta is not None
    assert session.flipped is not None
    return session.beta, session.flipped


def steps(session: CalibrationSession) -> int:
    """Number of different β settings."""
    return len(np.unique(np.round(np.mod(rows_of(session)[0], 2 * np.pi), 6)))


def full_turns(positions: int) -> tuple[Array, Array]:
    """β (R,), rad, in equal steps over a turn in both runs, and flipped (R,)."""
    turn = 2 * np.pi * np.arange(positions) / positions
    return np.tile(turn, 2), np.repeat(np.array([False, True]), positions)


def other_run(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Add the flipped (direct) run."""
    session = baseline.session
    runs = set(rows_of(session)[1].tolist())
    if len(runs) == 1:
        name = "direct" if True in runs else "flipped"
        planned = schedule(session, *full_turns(max(steps(session), FINE)))
        yield say("add the {name} run at the same positions", name=name), planned_on_stand(planned, baseline)


def repeat_reversed(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Go back through the same positions, so that time and position part."""
    beta, flipped = (np.concatenate([x, x[::-1]]) for x in rows_of(baseline.session))
    planned = schedule(baseline.session, beta, flipped)
    yield "repeat all positions in the reverse order, ending at the first", planned_on_stand(planned, baseline)


def mixed_order(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Visit the positions in a scattered order (golden-ratio steps), twice."""
    beta, flipped = rows_of(baseline.session)
    order = np.concatenate([np.argsort((np.arange(len(beta)) * ratio) % 1.0) for ratio in (0.618034, 0.4142136)])
    planned = schedule(baseline.session, beta[order], flipped[order])
    yield "measure the same positions twice in random order", planned_on_stand(planned, baseline)


def more_positions(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """More β steps in both runs."""
    for factor in (2, 4):
        positions = max(steps(baseline.session), FINE) * factor
        planned = schedule(baseline.session, *full_turns(positions))
        yield (
            say("measure {positions} equal steps of β in both runs", positions=positions),
            planned_on_stand(planned, baseline),
        )


def temperature_cycle(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Cycle the temperature against time and position."""
    session = baseline.session
    beta, flipped = (np.tile(x, 2) for x in rows_of(session))
    rows = len(beta)
    mean = 20.0 if session.temperature is None else float(session.temperature.mean())
    span = 5.0 if session.temperature is None else max(float(np.ptp(session.temperature)), 5.0)
    cycle = mean + span / 2 * np.sin(2 * np.pi * 2.7 * np.arange(rows) / rows)
    planned = replace(schedule(session, beta, flipped), temperature=cycle, time=PERIOD * np.arange(rows))
    words = say(
        "repeat the session while the temperature goes through almost three cycles of {span} °C", span=f"{span:.0f}"
    )
    yield words, planned_on_stand(planned, baseline)


def other_elevation(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Set the head to another elevation."""
    session = baseline.session
    assert session.stand is not None
    positions = max(steps(session), 2 * FINE)
    for degrees in (20.0, 60.0):
        stand = replace(session.stand, alpha=np.radians(degrees), chi=np.radians(degrees))
        planned = replace(schedule(session, *full_turns(positions)), stand=stand)
        parts = {"degrees": f"{degrees:.0f}", "positions": positions}
        words = say("repeat with the head at {degrees}°, {positions} positions in both runs", **parts)
        yield words, planned_on_stand(planned, baseline)


def repeated(baseline: Baseline) -> Iterator[tuple[str, Baseline]]:
    """Repeat and average: noise falls with the root of the number, that of a zero which does not repeat too.

    Longer readings would not do: a zero that differs from position to position stays what it is while it is read.
    """
    planned = planned_on_stand(schedule(baseline.session, *rows_of(baseline.session)), baseline)
    yield say("repeat the session {times} times", times=REPEATS), replace(planned, variance=planned.variance / REPEATS)


PROPOSALS: tuple[Proposal, ...] = (
    other_run,
    repeat_reversed,
    mixed_order,
    more_positions,
    temperature_cycle,
    other_elevation,
)
"""Proposals of another schedule, in the order in which a technician would rather make them."""
