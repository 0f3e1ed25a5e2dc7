"""The common part of all steps."""

from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine

from tests.lives.world import FindError, World

NUMBERS = st.integers(0, 13)
"""Numbers of sessions within a bench; in mixed order, so that late ones come too."""
WHICH = st.integers(0, 40)
"""Numbers of existing records, counted round."""
BY = {"by": "K. Ito", "why": "as the log book says"}
DONE = (200, 201, 202, 204, 404, 409, 422)
"""Answers to what may or may not be possible at the moment; which of them is right the other tests hold."""


class Steps(RuleBasedStateMachine):
    """A machine on a world that is given to it."""

    world: World

    def expect(self, holds: object, words: str) -> None:
        """A find where it does not hold."""
        if not holds:
            raise FindError(words)

    def tries(self, path: str, body: Any = None, method: str = "POST") -> dict[str, Any]:
        """Sends a request that may be refused at the moment; the answer's document, empty where it was refused."""
        answer = self.world.send(path, body, method)
        self.expect(answer.status_code in DONE or self.world.is_pending(answer), f"{path}: {answer.text[:400]}")
        if answer.status_code not in (200, 201) or "json" not in answer.headers.get("content-type", ""):
            return {}
        found = answer.json()
        return found if isinstance(found, dict) else {}

    def some_session(self, which: int, *states: str) -> dict[str, Any] | None:
        """One that there is, in one of some states or in any."""
        found = self.world.sessions(*states)
        return found[which % len(found)] if found else None

    def some_unit(self, which: int) -> str | None:
        """One that there is."""
        found = self.world.units()
        return found[which % len(found)] if found else None
