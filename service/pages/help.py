"""The page of help: what to do when, and what the words mean."""

from dataclasses import dataclass

from service.records.state import RecordState
from service.words.help import KEYS, MEASURES, WHEN, WORDS, plainly
from service.words.states import MEANINGS, STATES

COUNTS = "It counts: what is known of its unit rests on it."
"""Of an accepted record, where others say what they are not."""


@dataclass(frozen=True)
class HelpPage:
    """Everything the page of help shows, each as a word and what it means."""

    when: tuple[tuple[str, str], ...]
    states: tuple[tuple[str, str], ...]
    measures: tuple[tuple[str, str], ...]
    words: tuple[tuple[str, str], ...]
    keys: tuple[tuple[tuple[str, ...], str], ...]
    """Keys, and what they do."""


def help_page() -> HelpPage:
    """It is the same for everybody."""
    states = tuple((STATES[state], MEANINGS[state] or COUNTS) for state in RecordState)
    return HelpPage(WHEN, states, MEASURES, tuple((word, plainly(meaning)) for word, meaning in WORDS), KEYS)
