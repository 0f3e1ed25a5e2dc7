"""A session planned before it is measured, for a block on a cone or for units of a stored type."""

from estimator.planning import Plan
from estimator.planning import plan as plan_session
from service.errors import RefusedError
from service.planning.question import PlanQuestion
from service.planning.stored_type import asked_of, sensors_of, why_not
from service.storage import Storage

MOST_TYPES = 500
"""Types that are offered for a choice."""


def plan(storage: Storage, question: PlanQuestion) -> tuple[PlanQuestion, Plan]:
    """The question with what the type knows filled in, and its plan."""
    if not question.unit_type:
        like = question.cone()
        return question, plan_session(like, question.request(question.kind), sigma=question.sigma(like))
    with storage.database.reading() as store:
        unit_type = store.unit_types.get(question.unit_type)
    problems = why_not(unit_type)
    if problems:
        raise RefusedError(f"Units of the type {unit_type.name!r} cannot be planned for.", problems)
    whole = asked_of(question, unit_type)
    like = whole.block(sensors_of(unit_type))
    return whole, plan_session(like, whole.request(whole.kind), sigma=whole.sigma(like))


def plannable_types(storage: Storage) -> tuple[str, ...]:
    """Names of the stored types that can be planned for."""
    with storage.database.reading() as store:
        listed = store.unit_types.page(0, MOST_TYPES)
    return tuple(known.name for known in listed if not why_not(known))
