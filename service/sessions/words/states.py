"""What became of a record, in a sentence."""

from estimator.message import say
from service.kit.names import day_of
from service.sessions.states import RecordState, StateChange

STATES = {
    RecordState.ACCEPTED: "Accepted",
    RecordState.QUESTIONED: "Questioned",
    RecordState.WITHDRAWN: "Withdrawn",
    RecordState.SUPERSEDED: "Superseded",
}
MEANINGS = {
    RecordState.ACCEPTED: "",
    RecordState.QUESTIONED: "It is stored and drawn, and is no reference and no verdict until an engineer accepts it.",
    RecordState.WITHDRAWN: "It stays readable, and nothing that is known of the unit rests on it.",
    RecordState.SUPERSEDED: "Another session stands for it.",
}


def state_in_words(change: StateChange) -> str:
    """``Withdrawn on 21 Nov 2026 by K. Ito: wrong unit``."""
    return say(
        "{states} on {at} by {who}: {why}",
        states=STATES[change.state],
        at=day_of(change.at),
        who=change.who,
        why=change.why,
    )
