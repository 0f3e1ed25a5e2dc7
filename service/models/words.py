"""What another model moved in stored sessions, in words."""

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
UNTOUCHED = "no parameter changed"


def progress_of(found: Sequence[Recomputation]) -> str:
    """How far the sessions of all units have come, and what that moved; empty where none is computed again."""
    if not found:
        return ""
    done = [one.outcome for one in found if one.outcome is not None]
    waiting = sum(one.state is Progress.WAITING for one in found)
    sessions, moved = sum(one.recomputed for one in done), sum(len(one.verdicts) for one in done)
    units = say("{done} of {found}", done=len(done), found=_counted(len(found), "unit"))
    verdicts = say("verdict changed: {moved}", moved=_counted(moved, "session")) if moved else "no verdict changed"
    still = say(" {waiting} still to come.", waiting=_counted(waiting, "unit")) if waiting else ""
    return say(
        "{sessions} of {units} computed again: {verdicts}.{still}",
        sessions=_counted(sessions, "session"),
        units=units,
        verdicts=verdicts,
        still=still,
    )


def left_in_words(one: Recomputation) -> str:
    """Why a unit's sessions are as before; empty where its turn has not come."""
    match one.state:
        case Progress.GIVEN_UP:
            return GIVEN_UP
        case Progress.CANCELLED:
            return CANCELLED
        case _:
            return say(AGAIN, why=without_stop(one.failed)) if one.failed else ""


def moved_in_words(moved: MovedParameter | None) -> str:
    """``bias of A3 by −0.41 µg (U = 4.8 µg)``: the change beside the uncertainty of what changed."""
    if moved is None:
        return UNTOUCHED
    u = COVERAGE * moved.u
    measure = deviation_measure(moved.kind, moved.parameter, max(abs(moved.change), u))
    by, unsure = (_shown(value, measure) for value in (moved.change, u))
    return say(
        "{parameter} of {sensor} by {by} (U{hard}={hard}{unsure})",
        parameter=PARAMETER_NAMES[moved.parameter],
        sensor=moved.sensor,
        by=by,
        hard=HARD,
        unsure=unsure,
    )


def _shown(value: float, measure: Measure) -> str:
    """With two significant digits."""
    shown = value * measure.factor
    return f"{number(shown, decimals(abs(shown)))}{THIN}" + measure.label


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
