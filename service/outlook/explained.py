"""Step: changes with a diagnosis → the remaining changes of the sensors. Changes that a diagnosis attributes to the
stand, to the record, to temperature or to a course common to sensors are taken off before histories, dates and flags
are made.

The rest of a session's change is that of its calibration with the named causes in the model, whose covariance holds
their uncertainties. The part that was taken off, δ, belongs to the named cause with a probability p; where others are
possible it need not be there, so that u² = u'² + (1 − p)·δ² for the rest. A sensor with a cause of its own keeps its
whole change. For a reference the part is taken off the origin of all later changes.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.causes import cause
from estimator.diagnosis import Finding
from estimator.diagnosis.explanation.temperature import OF_TEMPERATURE
from estimator.health import ParameterJudgement, judge
from estimator.results import Calibration
from estimator.session import comparable
from service.diagnosis.records import Diagnosed
from service.diagnosis.store import Diagnoses
from service.diagnosis.words.causes import UNKNOWN_CAUSE
from service.kit.lock_order import outside_writing
from service.outlook.rules.histories import Left, Place
from service.outlook.store import ChangeRow, ReferenceRow
from service.sessions.calibrations_store import Calibrations
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.rules import tolerances_of
from service.types.store import UnitTypes

SHARED_SCOPES = ("stand", "fixture", "record")
"""Scopes of causes that act on no sensor."""


@dataclass(frozen=True, eq=False)
class _ExplainedSession:
    """One session whose diagnosis explains a part of its changes."""

    session: str
    found: Diagnosed
    calibration: Calibration
    """Calibration in force."""
    reference: Calibration
    """Reference from which its changes are counted."""


def left_of(
    store: Store, serial: str, changes: Sequence[ChangeRow], references: Sequence[ReferenceRow]
) -> dict[Place, Left]:
    """The rest of a unit's changes, where a diagnosis explains a part of them."""
    rows: tuple[ChangeRow | ReferenceRow, ...] = (*references, *changes)
    sessions = {row.session: (row.block, comparable(row.programme)) for row in rows}
    found = {id: diagnosed for id, diagnosed in Diagnoses(store).with_findings(sessions).items() if explains(diagnosed)}
    if not found:
        return {}
    first = {(r.block, comparable(r.programme)): r.session for r in reversed(references)}
    against = {id: first[sessions[id]] for id in found if sessions[id] in first}
    known = Calibrations(store).in_force({*against, *against.values()})
    of_type = UnitTypes(store).of_unit(serial)
    explained = (_ExplainedSession(id, found[id], known[id], known[reference]) for id, reference in against.items())
    return {place: left for session in explained for place, left in _left(session, of_type).items()}


@outside_writing
def _left(session: _ExplainedSession, of_type: UnitType) -> dict[Place, Left]:
    tolerances = tolerances_of(of_type, session.reference)
    whole = {(j.sensor, j.parameter): j for j in judge(session.calibration, session.reference, tolerances)}
    rest = {(j.sensor, j.parameter): j for j in judge(session.found.calibration, session.reference, tolerances)}
    doubt, apart = _doubt(session.found.findings), _with_causes_of_their_own(session.found.findings)
    pairs = {key: (whole[key], rest[key]) for key in whole.keys() & rest.keys() if key[0] not in apart}
    found = {(session.session, *key): _beside(*pair, doubt) for key, pair in pairs.items()}
    return {place: left for place, left in found.items() if left is not None}


def _beside(whole: ParameterJudgement, rest: ParameterJudgement, doubt: float) -> Left | None:
    """The rest of one change; None where either is not known."""
    if whole.change is None or rest.change is None or rest.change_own is None:
        return None
    part = np.subtract(whole.change, rest.change)
    sigma = np.sqrt(np.square(rest.change_own) + doubt * part**2)
    return Left(change=list(rest.change), sigma=sigma.tolist(), dof=rest.dof, part=part.tolist())


def explains(found: Diagnosed) -> bool:
    """Whether any of what was named is no sensor's own, and every sensor that has a cause of its own is known."""
    individual = [finding for finding in found.findings if not _is_shared(finding)]
    return len(individual) < len(found.findings) and all(finding.sensors for finding in individual)


def _is_shared(finding: Finding) -> bool:
    """Whether it is no sensor's own, whichever of the possible causes it is."""
    if finding.cause == UNKNOWN_CAUSE:
        return False
    possible = (name for name in (finding.cause, *finding.alternatives) if name != UNKNOWN_CAUSE)
    are_shared = (name in OF_TEMPERATURE or cause(name).scope in SHARED_SCOPES for name in possible)
    return finding.shared is not None or all(are_shared)


def _with_causes_of_their_own(findings: Iterable[Finding]) -> set[str]:
    return {sensor for finding in findings if not _is_shared(finding) for sensor in finding.sensors}


def _doubt(findings: Iterable[Finding]) -> float:
    """Chance that one of the named causes at least is another one of those that are possible."""
    return float(1 - np.prod([_probability(finding) for finding in findings]))


def _probability(finding: Finding) -> float:
    """Probability of the named cause among the possible ones; all are equally likely if the ranking lacks it, or lacks
    the unknown one, as diagnoses of earlier versions do."""
    if not finding.alternatives:
        return 1.0
    ranked = {rival.cause: rival.probability for rival in reversed(finding.ranking)}
    possible = [ranked.get(name, 0.0) for name in (finding.cause, *finding.alternatives)]
    is_complete = UNKNOWN_CAUSE in ranked or UNKNOWN_CAUSE not in finding.alternatives
    return possible[0] / sum(possible) if is_complete and possible[0] > 0 else 1 / len(possible)
