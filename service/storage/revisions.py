"""What is wrong with the revision that a database is at, and what to do about it."""

from estimator.message import say
from service.storage.schema import head_revision, is_known


def unfit(found: str | None) -> str | None:
    """Why this version cannot work with a revision; None for the one that it needs."""
    needed = head_revision()
    if found == needed:
        return None
    if found is not None and not is_known(found):
        return say(
            "The database's schema is at {revision}, which a newer version of the program made; this "
            "one goes up to {needed_revision}: run the newer version.",
            revision=found,
            needed_revision=needed,
        )
    return say(
        "The database's schema is at {revision}, this version needs {needed_revision}: run `imu-health db upgrade`.",
        revision=found or "nothing",
        needed_revision=needed,
    )
