"""What became of a unit's stored sessions when they were computed again, in a sentence."""


def recalibrated_in_words(recomputed: int, unchanged: int, left: int) -> str:
    """``3 sessions were computed again under the model in force.``; empty where nothing was asked."""
    told = [
        (recomputed, "computed again under the model in force"),
        (unchanged, "left alone, on this model already"),
        (left, "left alone: the model's causes cannot be told from them"),
    ]
    said = [f"{_sessions(count)} {what}" for count, what in told if count]
    return f"{'; '.join(said)}." if said else ""


def _sessions(count: int) -> str:
    return "1 session was" if count == 1 else f"{count} sessions were"
