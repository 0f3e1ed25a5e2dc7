"""Whether the service may write where it keeps its data, found out at its start."""

from pathlib import Path
from tempfile import TemporaryFile

from estimator.message import say
from service.errors import ServiceError


def require_writable(folder: Path) -> None:
    """Makes the folder where it is missing; ServiceError that says what to do where nothing can be written there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as fault:
        raise ServiceError(
            say(
                "The folder {folder} cannot be written: {strerror}. Give the service's user the right to "
                "write there, or name another one with --data-folder or IMU_HEALTH_DATA_FOLDER.",
                folder=folder,
                strerror=fault.strerror or fault,
            )
        ) from fault
