"""Results of recomputation in words."""

from collections.abc import Sequence

from estimator.message import say, without_stop
from service.kit.measures import COVERAGE, HARD, PARAMETER_NAMES, THIN, Measure, decimals, deviation_measure, number
from service.models.records import MovedParameter, Progress, Recomputation

GIVEN_UP = (
    "The program failed at it, several times: its sessions keep what they had. An administrator can try again: see "
    "Failed work on the page Jobs."
)
AGAIN = "The last try failed: {why}. It is retried automatically."
CANCELLED = "Cancelled before its turn: its sessions keep what they had."
NO_CHANGE = "no parameter changed"


def progress_of(recomputations: Sequence[Recomputation]) -> str:
    """State of the recomputation of all units, and changed verdicts; empty without any."""
    if not recomputations:
        return ""
    done = [recomputation.outcome for recomputation in recomputations if recomputation.outcome is not None]
    waiting = sum(recomputation.state is Progress.WAITING for recomputation in recomputations)
    sessions, changed = (
        sum(recomputation.recomputed for recomputation in done),
        sum(len(recomputation.verdicts) for recomputation in done),
    )
    units = say("{done} of {units}", done=len(done), units=_counted(len(recomputations), "unit"))
    verdicts = (
        say("verdict changed: {sessions}", sessions=_counted(changed, "session")) if changed else "no verdict changed"
    )
    remaining = say(" {waiting} still to come.", waiting=_counted(waiting, "unit")) if waiting else ""
    parts = {"sessions": _counted(sessions, "session"), "units": units, "verdicts": verdicts, "progress": remaining}
    return say("{sessions} of {units} computed again: {verdicts}.{progress}", **parts)


def left_in_words(recomputation: Recomputation) -> str:
    """The reason why a unit's sessions are as before; empty while it waits."""
    match recomputation.state:
        case Progress.GIVEN_UP:
            return GIVEN_UP
        case Progress.CANCELLED:
            return CANCELLED
        case _:
            return say(AGAIN, why=without_stop(recomputation.failed)) if recomputation.failed else ""


def moved_in_words(moved: MovedParameter | None) -> str:
    """``bias of A3 by −0.41 µg (U = 4.8 µg)``: the change beside the uncertainty of the parameter."""
    if moved is None:
        return NO_CHANGE
    u = COVERAGE * moved.u
    measure = deviation_measure(moved.kind, moved.parameter, max(abs(moved.change), u))
    amplitude, uncertainty = (_shown(value, measure) for value in (moved.change, u))
    return say(
        "{parameter} of {sensor} by {amplitude} (U{nbsp}={nbsp}{uncertainty})",
        parameter=PARAMETER_NAMES[moved.parameter],
        sensor=moved.sensor,
        amplitude=amplitude,
        nbsp=HARD,
        uncertainty=uncertainty,
    )


def _shown(value: float, measure: Measure) -> str:
    """The value with two significant digits."""
    shown = value * measure.factor
    return f"{number(shown, decimals(abs(shown)))}{THIN}" + measure.label


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"
