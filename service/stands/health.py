"""The stands' own health, from the motions common to the sensors of the units measured on them."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache

import numpy as np

from estimator.health.common_motion import sigma_of, size_of
from estimator.health.stands import StandMotion, StandShift, StandState, stand_states
from service.kit.copying import copied
from service.kit.measures import YEAR
from service.stands.records import MotionOnStand, StandCondition, StandEvidence, StandSeating
from service.stands.store import Stands
from service.stands.words import reason_of
from service.storage.queries import Store


def stand_health(store: Store) -> tuple[StandCondition, ...]:
    """Every stand with its condition and the evidence, by name."""
    every = Stands(store).motions()
    whole = [motion for motion in every if motion.is_whole]
    quantities = dict.fromkeys((motion.kind, motion.quantity) for motion in whole)
    found = [f for quantity in quantities for f in _found(tuple(m for m in whole if (m.kind, m.quantity) == quantity))]
    return tuple(_condition(stand, every, found) for stand in sorted({motion.stand for motion in every}))


@dataclass(frozen=True)
class _Found:
    kind: str
    quantity: str
    start: datetime
    """Origin of the years."""
    state: StandState

    @property
    def seating(self) -> StandSeating:
        return StandSeating(self.kind, self.quantity, self.state.seating)

    @property
    def worst(self) -> StandEvidence | None:
        """The most evident shift, or what chance may explain."""
        worst = self.state.worst
        return None if worst is None else self._evidence(worst)

    @property
    def shifts(self) -> list[StandEvidence]:
        return [self._evidence(shift) for shift in self.state.shifts]

    def _evidence(self, shift: StandShift) -> StandEvidence:
        return copied(
            StandEvidence,
            shift,
            kind=self.kind,
            quantity=self.quantity,
            since=self.start + shift.since * YEAR,
            until=None if shift.until is None else self.start + shift.until * YEAR,
            size=size_of(self.quantity, shift.value),
            sigma=sigma_of(shift.value, shift.covariance),
            has_shifted=bool(self.state.shifts),
        )


@lru_cache(maxsize=8)
def _found(measured: tuple[MotionOnStand, ...]) -> tuple[_Found, ...]:
    """The states of all stands by the motions of one quantity; years count from the first of them.

    Pages ask for it again and again between two uploads: the result for the same motions is cached.
    """
    kind, quantity, start = measured[0].kind, measured[0].quantity, measured[0].at
    motions = [
        StandMotion(
            stand=motion.stand,
            unit=f"{motion.unit}/{motion.epoch}",
            time=(motion.at - start) / YEAR,
            value=np.array(motion.value),
            covariance=np.array(motion.covariance),
        )
        for motion in measured
    ]
    return tuple(_Found(kind, quantity, start, state) for state in stand_states(motions))


def _condition(stand: str, motions: Sequence[MotionOnStand], found: Sequence[_Found]) -> StandCondition:
    of_stand = [f for f in found if f.state.stand == stand]
    evidence = tuple(f.worst for f in of_stand if f.worst is not None)
    shifts = tuple(sorted((shift for f in of_stand for shift in f.shifts), key=lambda shift: shift.since))
    seating = tuple(f.seating for f in of_stand)
    measured = [motion for motion in motions if motion.stand == stand]
    return StandCondition(
        stand=stand,
        sessions=len({(m.unit, m.at) for m in measured if m.is_whole}),
        has_shifted=any(shift.until is None for shift in shifts),
        reason=reason_of(evidence, shifts, seating),
        evidence=evidence,
        shifts=shifts,
        seating=seating,
        unreadable=tuple(dict.fromkeys(motion.session for motion in measured if not motion.is_whole)),
    )
