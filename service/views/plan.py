"""A session planned before it is measured, for a block on a cone or for units of a stored type."""

from numpy.linalg import LinAlgError

from estimator.errors import Problem
from estimator.planning import Plan
from estimator.planning import plan as plan_session
from estimator.session import CalibrationSession
from service.errors import RefusedError
from service.planning.question import PlanQuestion
from service.planning.stored_type import asked_of, sensors_of, why_not
from service.storage import Storage

AMOUNTS = ("theta", "alpha_error", "beta_error", "noise", "variation")
TOO_FAR_APART = "This cannot be planned: errors of the stand and noise lie too many orders of magnitude apart."
APART = "bring it nearer to the others"
MOST_TYPES = 500
"""Types that are offered for a choice."""


def plan(storage: Storage, question: PlanQuestion) -> tuple[PlanQuestion, Plan]:
    """The question with what the type knows filled in, and its plan."""
    if not question.unit_type:
        return question, _planned(question, question.cone(), question.kind)
    with storage.database.reading() as store:
        unit_type = store.unit_types.get(question.unit_type)
    problems = why_not(unit_type)
    if problems:
        raise RefusedError(f"Units of the type {unit_type.name!r} cannot be planned for.", problems)
    whole = asked_of(question, unit_type)
    return whole, _planned(whole, whole.block(sensors_of(unit_type)), whole.kind)


def _planned(question: PlanQuestion, like: CalibrationSession, kind: str) -> Plan:
    """The plan; RefusedError where the amounts are such that no computation of 16 digits holds them together."""
    try:
        return plan_session(like, question.request(kind), sigma=question.sigma(like))
    except LinAlgError as fault:
        raise RefusedError(TOO_FAR_APART, tuple(Problem(name, APART) for name in AMOUNTS)) from fault


def plannable_types(storage: Storage) -> tuple[str, ...]:
    """Names of the stored types that can be planned for."""
    with storage.database.reading() as store:
        listed = store.unit_types.page(0, MOST_TYPES)
    return tuple(known.name for known in listed if not why_not(known))
