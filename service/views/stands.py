"""The stands' own health, from what the units measured on them did together."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

import numpy as np

from estimator.health.common_motion import sigma_of, size_of
from estimator.health.stands import Motion, StandShift, stand_shifts
from service.records.stand import MotionOnStand, StandCondition, StandEvidence
from service.storage.store import Store
from service.words.names import YEAR
from service.words.stands import STEADY, TOO_FEW, why_shifted


def stand_conditions(store: Store) -> tuple[StandCondition, ...]:
    """Every stand with its condition and the evidence, by name."""
    every = store.stands.motions()
    motions = [motion for motion in every if motion.is_whole]
    lost = {
        motion.stand: tuple(m.session for m in every if m.stand == motion.stand and not m.is_whole) for motion in every
    }
    evidence: dict[str, list[StandEvidence]] = {motion.stand: [] for motion in sorted(every, key=lambda m: m.stand)}
    for kind, quantity in dict.fromkeys((motion.kind, motion.quantity) for motion in motions):
        own = [motion for motion in motions if (motion.kind, motion.quantity) == (kind, quantity)]
        for shift in _shifts(own):
            if shift.p_value is not None:
                evidence[shift.stand].append(_evidence(shift, kind, quantity, own[0].at))
    sessions = {stand: {(m.unit, m.at) for m in motions if m.stand == stand} for stand in evidence}
    return tuple(
        replace(_condition(stand, len(sessions[stand]), found), unreadable=lost[stand])
        for stand, found in evidence.items()
    )


def _shifts(own: Sequence[MotionOnStand]) -> tuple[StandShift, ...]:
    """By years from the first of them."""
    return stand_shifts(
        [
            Motion(
                stand=motion.stand,
                unit=f"{motion.unit}/{motion.epoch}",
                time=(motion.at - own[0].at) / YEAR,
                value=np.array(motion.value),
                covariance=np.array(motion.covariance),
            )
            for motion in own
        ]
    )


def _evidence(shift: StandShift, kind: str, quantity: str, start: datetime) -> StandEvidence:
    return StandEvidence(
        kind=kind,
        quantity=quantity,
        since=start + (shift.since or 0.0) * YEAR,
        value=shift.value,
        size=size_of(quantity, shift.value),
        sigma=sigma_of(shift.value, shift.covariance),
        p_value=shift.p_value or 0.0,
        units=shift.units,
        agreeing=shift.agreeing,
        has_shifted=shift.has_shifted,
    )


def _condition(stand: str, sessions: int, found: Sequence[StandEvidence]) -> StandCondition:
    shifted = [evidence for evidence in found if evidence.has_shifted]
    if not shifted:
        return StandCondition(stand, sessions, False, STEADY if found else TOO_FEW, tuple(found))
    worst = min(shifted, key=lambda evidence: evidence.p_value)
    return StandCondition(stand, sessions, True, why_shifted(worst), tuple(found))
