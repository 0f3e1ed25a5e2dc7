"""Inputs from which, with the session's file, the numbers of a certificate can be computed again."""

from dataclasses import dataclass

from estimator.codec import Document
from estimator.health.temperature_law import TemperatureStep
from service.judging.covered import CoveredTemperatures
from service.models.records import Model
from service.papers.certified import CertifiedSession, ReferenceSession
from service.sessions.decision import Decision, nominal_factor_of, steps_in
from service.stands.records import StandCertificate
from service.storage.json_text import STORED, json_text


@dataclass(frozen=True, eq=False)
class RecomputationInputs(Document, format="imu-recomputation/1"):
    """Inputs of the recomputation as stated in the certificate."""

    coverage_factor: float
    """k for known noise."""
    model: Model
    is_reference: bool
    rule: str
    """Decision rule with its version and the revision of the tolerances; empty where nothing is judged."""
    tolerances: tuple[tuple[str, str, float], ...]
    """Kind of sensor, or a sensor with one of its own, parameter, tolerance: relative for scale, else SI."""
    reference: ReferenceSession | None
    stand_certificate: StandCertificate | None
    laws: tuple[tuple[str, str, TemperatureStep], ...] = ()
    """Sensor, parameter, and the correction for temperature before the judgement."""
    temperatures: CoveredTemperatures | None = None
    """Temperatures covered by the calibration together with the unit's earlier sessions."""


def inputs_json(found: CertifiedSession) -> str:
    """The inputs of the recomputation as JSON; the same certificate gives the same text."""
    decisions = found.report.decisions
    inputs = RecomputationInputs(
        coverage_factor=nominal_factor_of(decisions),
        model=found.model,
        is_reference=found.report.session.is_reference,
        rule=f"{decisions[0].rule}" if decisions else "",
        tolerances=_tolerances(decisions),
        reference=found.reference,
        stand_certificate=found.traceability.certificate,
        laws=tuple((*place, step) for place, step in steps_in(decisions).items()),
        temperatures=found.temperatures,
    )
    return json_text(STORED.written(inputs))


def _tolerances(decisions: tuple[Decision, ...]) -> tuple[tuple[str, str, float], ...]:
    """The smallest of each kind, then those of sensors that have another."""
    of_kind: dict[tuple[str, str], float] = {}
    for d in decisions:
        of_kind[d.kind, d.parameter] = min(d.tolerance, of_kind.get((d.kind, d.parameter), d.tolerance))
    own = {(d.sensor, d.parameter): d.tolerance for d in decisions if d.tolerance != of_kind[d.kind, d.parameter]}
    return tuple((*place, tolerance) for place, tolerance in (of_kind | own).items())
