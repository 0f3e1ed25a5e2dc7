"""How much room is left where uploads are kept."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from estimator.message import say


@dataclass(frozen=True)
class Space:
    """Bytes that are free, and below which no upload is taken."""

    free: int
    least: int

    @property
    def too_little(self) -> str | None:
        """Why no upload is taken; None while there is room."""
        if self.free >= self.least:
            return None
        return say(
            "The disk of uploaded files has {free} MiB left, less than the {least} MiB that are kept "
            "free, so no upload is taken. What is stored can be read as before.",
            free=f"{self.free / 2**20:.0f}",
            least=f"{self.least / 2**20:.0f}",
        )


def space_at(folder: Path, least: int) -> Space:
    """The room of a folder that may not be made yet."""
    made = next(place for place in (folder, *folder.parents) if place.exists())
    return Space(shutil.disk_usage(made).free, least)
