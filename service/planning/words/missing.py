"""What a session still lacks, in words."""

from itertools import groupby

import numpy as np

from estimator.planning import Missing
from service.kit.measures import MINUS, number

MOST = 12
"""Angles that are named; the rest are counted."""


def missing_in_words(found: Missing) -> tuple[str, ...]:
    """A sentence how far it is, then one a run or a line a direction, then what is open until then."""
    if found.is_complete:
        return (f"Complete: {found.done} positions, and every parameter is observed.",)
    to_come = len(found.settings) or len(found.directions)
    done = found.done
    lines = [f"{done} position{'' if done == 1 else 's'} {'is' if done == 1 else 'are'} done, {to_come} still to come."]
    for run, settings in groupby(found.settings, key=lambda one: one[0]):
        angles = [f"{number(float(np.degrees(beta)), 2).rstrip('0').rstrip('.')}°" for _, beta in settings]
        rest = f" and {len(angles) - MOST} more" if len(angles) > MOST else ""
        lines.append(f"{run}: β = {', '.join(angles[:MOST])}{rest}")
    lines += [f"up along {_vector(direction)} in block axes" for direction in found.directions.tolist()]
    if found.unseen:
        lines.append(f"Until then open: {', '.join(found.unseen[:MOST])}{' …' if len(found.unseen) > MOST else ''}.")
    return tuple(lines)


def _vector(direction: list[float]) -> str:
    return f"({', '.join(f'{part:.2f}'.replace('-', MINUS) for part in direction)})"
