"""Whether the revision of a database fits this version, and what to do where it does not."""

from typing import TYPE_CHECKING

from estimator.message import say
from estimator.on_demand import function_on_demand

if TYPE_CHECKING:
    from service.storage.schema import head_revision, is_known
else:
    head_revision = function_on_demand("service.storage.schema", "head_revision")
    is_known = function_on_demand("service.storage.schema", "is_known")


def unfit(revision: str | None) -> str | None:
    """Why this version cannot work with a revision; None for the one that it needs."""
    needed = head_revision()
    if revision == needed:
        return None
    if revision is not None and not is_known(revision):
        return say(
            "The database's schema is at {revision}, which a newer version of the program made; this "
            "one goes up to {needed_revision}: run the newer version.",
            revision=revision,
            needed_revision=needed,
        )
    return say(
        "The database's schema is at {revision}, this version needs {needed_revision}: run `imu-health db upgrade`.",
        revision=revision or "nothing",
        needed_revision=needed,
    )
