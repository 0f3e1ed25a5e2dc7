"""Step: the causes beyond the baseline in a session's calibration."""

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

from estimator.groups.fixed import FixedEffect, in_one_session
from estimator.groups.layout import EVERY
from estimator.moments import moment
from estimator.results import SensorCalibration
from service.ingest.checked import Checked
from service.models.records import AcceptedFinding, Model, ModelRevision, Pooled, Scope
from service.models.store import Models
from service.storage.queries import Store

BEGINNING_OF_TIME = datetime.min.replace(tzinfo=UTC)
PRECEDENCE = (Scope.UNIT, Scope.UNIT_TYPE, Scope.STAND)
"""Precedence of sizes for one cause on one sensor: every group is pooled on the plain simulation, so each size is the
whole effect."""


def in_force(revisions: Sequence[ModelRevision]) -> tuple[ModelRevision, ...]:
    """The accepted causes that are not withdrawn."""
    withdrawn = {r.withdraws for r in revisions}
    return tuple(r for r in revisions if r.withdraws is None and r.id not in withdrawn)


def model_as_of(revisions: Sequence[ModelRevision], number: int) -> tuple[ModelRevision, ...]:
    """The causes in force when a revision was the latest."""
    return in_force([revision for revision in revisions if revision.id <= number])


def model_of(revisions: Sequence[ModelRevision], at: datetime) -> Model:
    """The model composed of revisions for a session at a time; the same cause on the same sensors counts once."""
    accepted = in_force(revisions)
    causes = dict.fromkeys((r.cause, r.sensors) for r in accepted if pooled_of(r) is None)
    ordered = sorted(accepted, key=lambda r: (PRECEDENCE.index(r.scope), -r.id))
    return Model(max((r.id for r in revisions), default=0), tuple(causes), tuple(_fixed(ordered, at)))


def model_for(store: Store, new: Checked) -> Model:
    """The model for a session that is not stored yet."""
    return model_of(Models(store).for_upload(new.session.unit, new.type_name, new.stand), new.measured_at)


def pooled_of(revision: ModelRevision) -> Pooled | None:
    """A revision's facts from a group; None for a single session."""
    return None if revision.evidence is None else revision.evidence.pooled


def places_of(revision: ModelRevision, sensors: Sequence[SensorCalibration]) -> tuple[str, ...]:
    """The sensors of a block affected by a revision's cause, by name; an empty name for a cause of stand or fixture."""
    pooled = pooled_of(revision)
    if EVERY in revision.sensors and pooled is not None:
        return tuple(sensor.name for sensor in sensors if sensor.kind == pooled.kind)
    return revision.sensors or ("",)


def _fixed(revisions: Sequence[ModelRevision], at: datetime) -> Iterator[FixedEffect]:
    """Effects from groups; one with a start applies only to sessions after it."""
    for revision in revisions:
        evidence, pooled = revision.evidence, pooled_of(revision)
        if evidence is not None and pooled is not None and at >= _start_of(revision, pooled):
            yield _effect(revision, evidence, pooled)


def _effect(revision: ModelRevision, evidence: AcceptedFinding, pooled: Pooled) -> FixedEffect:
    return FixedEffect(
        cause=revision.cause,
        sensors=revision.sensors,
        kind=pooled.kind,
        amplitude=evidence.amplitude,
        sigma=in_one_session(evidence.sigma, pooled.spread),
        shape=pooled.shape,
        varies=pooled.form == "varying",
        words=pooled.words,
    )


def _start_of(revision: ModelRevision, pooled: Pooled) -> datetime:
    """Start of the effect; where earlier versions did not record it, its acceptance."""
    if pooled.form != "since":
        return BEGINNING_OF_TIME
    return revision.accepted_at if pooled.since is None else moment(pooled.since)
