"""What a session still lacks, in words."""

from itertools import groupby

import numpy as np

from estimator.message import joined, say, say_count
from estimator.planning import Missing
from service.kit.measures import MINUS, number

MOST = 12
"""Angles that are named; the rest are counted."""


def missing_in_words(found: Missing) -> tuple[str, ...]:
    """A sentence how far it is, then one a run or a line a direction, then what is open until then."""
    if found.is_complete:
        return (say("Complete: {done} positions, and every parameter is observed.", done=found.done),)
    to_come = len(found.settings) or len(found.directions)
    done = found.done
    lines: list[str] = [
        say_count(
            "{n} position is done, {to_come} still to come.",
            "{n} positions are done, {to_come} still to come.",
            done,
            to_come=to_come,
        )
    ]
    for run, settings in groupby(found.settings, key=lambda one: one[0]):
        angles = [f"{number(float(np.degrees(beta)), 2).rstrip('0').rstrip('.')}°" for _, beta in settings]
        rest = say(" and {most} more", most=len(angles) - MOST) if len(angles) > MOST else ""
        lines.append(say("{run}: β = {angles}{rest}", run=run, angles=", ".join(angles[:MOST]), rest=rest))
    lines += [
        say("up along {direction} in block axes", direction=_vector(direction))
        for direction in found.directions.tolist()
    ]
    if found.unseen:
        lines.append(
            say("Until then open: {unseen} ….", unseen=joined(", ", found.unseen[:MOST]))
            if len(found.unseen) > MOST
            else say("Until then open: {unseen}.", unseen=joined(", ", found.unseen[:MOST]))
        )
    return tuple(lines)


def _vector(direction: list[float]) -> str:
    return f"({', '.join(f'{part:.2f}'.replace('-', MINUS) for part in direction)})"
