"""Step: how far another model moved the parameters and the verdicts of sessions."""

from collections.abc import Iterator, Mapping, Sequence
from math import dist

from service.models.records import MovedParameter, MovedVerdict
from service.sessions.records import ParameterValue, StoredSession


def moved_verdicts(before: Mapping[str, StoredSession], after: Sequence[StoredSession]) -> Iterator[MovedVerdict]:
    """Accepted sessions with another verdict than before, in their order."""
    for now in after:
        was = before.get(now.id)
        if was is not None and was.state is now.state and was.verdict is not now.verdict:
            yield MovedVerdict(now.id, now.started_at, was.verdict, now.verdict)


def moved_parameters(
    session: str, before: Sequence[ParameterValue], after: Sequence[ParameterValue]
) -> Iterator[MovedParameter]:
    """Every parameter that both calibrations of a session give, and by how much it moved."""
    known = {(value.sensor, value.parameter): value for value in before}
    for now in after:
        was = known.get((now.sensor, now.parameter))
        change = None if was is None else _change(was, now)
        if change is not None and was is not None and was.u:
            yield MovedParameter(session, now.sensor, now.kind, now.parameter, change, _uncertainty(was))


def furthest(moved: Sequence[MovedParameter]) -> MovedParameter | None:
    """The one that moved most, in its own uncertainty; None where nothing did."""
    found = max(moved, key=lambda one: abs(one.change) / one.u, default=None)
    return found if found is not None and found.change else None


def _change(was: ParameterValue, now: ParameterValue) -> float | None:
    """Relative of a scale factor; of an axis the angle between its directions, rad."""
    if was.axis is not None and now.axis is not None:
        return dist(was.axis, now.axis)
    if was.value is None or now.value is None:
        return None
    change = now.value - was.value
    return change / was.value if was.parameter == "scale" else change


def _uncertainty(was: ParameterValue) -> float:
    """In the unit of its change."""
    assert was.u is not None
    return was.u / abs(was.value) if was.parameter == "scale" and was.value else was.u
