"""Names the slip behind a grossly wrong reading: by what it reads and by what it should."""

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from estimator.calibration.gross_linear import AGREES, Predicted
from estimator.message import joined, say
from estimator.session import Array, CalibrationSession, SetAside

ZERO, SIGN, DECIMAL, NEIGHBOUR = "zero", "sign", "decimal-point", "neighbour-column"
BEFORE, UNPLUGGED, STUCK, UNKNOWN = "row-before", "unplugged", "stuck", "unknown"

PLAIN = frozenset((ZERO, SIGN, DECIMAL, NEIGHBOUR, BEFORE, UNPLUGGED, STUCK))
"""Slips that no sensor and no stand imitates: an effect of physics hits their value by chance alone."""

LONG = 3
"""Equal readings in a row that are a stuck channel: two are a row written twice."""

SAME = 1e-12
"""Relative difference of equal readings: means of equal samples differ by rounding."""

CONSTANT = 1e-3
"""Part of a channel's usual standard error of a mean: a row far below it had no noise, so no sensor was connected."""

MOVED = 2
"""Places by which a decimal point is likely to slip."""

CLOSE = 0.02
"""Part of a slip's size within which the reading must meet it: by chance one of all slips does in a tenth of the cases
that have no other name."""


def same(readings: Array) -> Array:
    """(..., R − 1, m) bool: readings (..., R, m) that are those of the row before."""
    return np.asarray(np.abs(np.diff(readings, axis=-2)) <= SAME * np.abs(readings[..., 1:, :]))


def stuck(readings: Array) -> Array:
    """(..., R, m) bool: readings (..., R, m) that several rows in a row share."""
    equal, edge = same(readings), np.zeros((*readings.shape[:-2], 1, readings.shape[-1]), dtype=bool)
    after, before = np.concatenate([equal, edge], axis=-2), np.concatenate([edge, equal], axis=-2)
    centre = after & before
    left, right = (
        np.concatenate([centre[..., 1:, :], edge], axis=-2),
        np.concatenate([edge, centre[..., :-1, :]], axis=-2),
    )
    return np.asarray(centre | left | right)


def slip_of(session: CalibrationSession, predicted: Predicted, j: int, i: int) -> str:
    """The likely slip of the reading of sensor i in row j."""
    u, right, sigma = session.readings, predicted.value[j, i], AGREES * predicted.sigma[j, i]
    wrong, middle = u[j, i], session.sensors[i].nominal_offset or 0.0

    def meets(value: float, spread: float = sigma) -> bool:
        return bool(abs(wrong - value) <= max(min(spread, CLOSE * abs(wrong - right)), SAME * abs(value)))

    if without_noise(session, j, i):
        return UNPLUGGED
    if stuck(u)[j, i]:
        return UNPLUGGED if wrong == 0 else STUCK
    if wrong == 0:
        return ZERO
    if j > 0 and meets(u[j - 1, i]):
        return BEFORE
    if any(meets(u[j, k]) for k in range(u.shape[1]) if k != i):
        return NEIGHBOUR
    if meets(2 * middle - right) or meets(-right):
        return SIGN
    powers = [10.0**k for k in range(-MOVED, MOVED + 1) if k]
    return DECIMAL if any(meets(right * power, power * sigma) for power in powers) else UNKNOWN


def without_noise(session: CalibrationSession, j: int, i: int) -> bool:
    """Whether a mean of samples of a raw log had no noise, as others of its channel have."""
    if session.at_ends is None:
        return False
    errors = session.standard_errors[:, i]
    return bool(errors[j] <= CONSTANT * np.nanmedian(errors))


LIKELY = {
    ZERO: "the reading is zero",
    SIGN: "its sign is lost",
    DECIMAL: "its decimal point has moved",
    NEIGHBOUR: "it is another channel's reading",
    BEFORE: "it repeats the row before",
    UNPLUGGED: "the channel was not connected",
    STUCK: "the channel stood still",
}
"""Words for each slip."""


def sentences(found: Sequence[SetAside]) -> tuple[str, ...]:
    """The readings set aside, in words; a row that repeats the one before in several channels is one thing."""
    said = list[str]()
    for row, group in groupby(found, key=lambda aside: (aside.row, aside.slip == BEFORE)):
        together = list(group)
        if row[1] and len(together) > 1:
            said.append(
                say(
                    "Row {row} repeats the row before in {sensors}; these readings were left out. Was the block "
                    "turned? If the right readings are known, correct the file and upload it again.",
                    row=row[0],
                    sensors=joined(", ", (aside.sensor for aside in together)),
                )
            )
        else:
            said += map(in_words, together)
    return tuple(said)


def in_words(aside: SetAside) -> str:
    """One reading set aside, and what to do about it."""
    slip = LIKELY.get(aside.slip)
    likely = say(": {slip}", slip=slip) if slip else ""
    parts = {
        "sensor": aside.sensor,
        "row": aside.row,
        "last": aside.last_row,
        "reading": f"{aside.reading:.6g}",
        "expected": f"{aside.expected:.6g}",
        "likely": likely,
    }
    if aside.suspects:
        who = joined(", ", aside.suspects)
        return say(
            "Row {row} does not fit: one of {who} is wrong by much and its row cannot tell which; the row was left "
            "out. Correct the file and upload it again if you know.",
            who=who,
            **parts,
        )
    if not np.isfinite(aside.expected):
        return say(
            "{sensor} reads {reading} from row {row} to row {last}{likely}; these readings were left out. Check the "
            "channel and repeat these rows.",
            **parts,
        )
    if aside.last_row > aside.row:
        return say(
            "{sensor} reads {reading} from row {row} to row {last}, where {expected} was expected in the first"
            "{likely}; these readings were left out. Check the channel and repeat these rows, or correct the file and "
            "upload it again.",
            **parts,
        )
    return say(
        "{sensor} reads {reading} in row {row}, where {expected} was expected{likely}; it was left out. If the right "
        "reading is known, correct the file and upload it again.",
        **parts,
    )
