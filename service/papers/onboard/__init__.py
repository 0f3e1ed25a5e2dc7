"""The correction of a session as other systems' parameter files, each with what that system cannot hold."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from service.papers.onboard import autopilots, kalibr, ros2
from service.papers.onboard.given import ExportInput

__all__ = ["FORMS", "Form", "System"]


class System(StrEnum):
    """System for which parameters are written."""

    PX4 = "px4"
    ARDUPILOT = "ardupilot"
    KALIBR = "kalibr"
    ROS2 = "ros2"


@dataclass(frozen=True)
class ExportForm:
    """Form of a system's parameter file."""

    name: str
    """Usual name of the system."""
    ending: str
    """Extension of the file's name."""
    written: Callable[[ExportInput], str]


FORMS = {
    System.PX4: ExportForm("PX4", "params", autopilots.px4),
    System.ARDUPILOT: ExportForm("ArduPilot", "parm", autopilots.ardupilot),
    System.KALIBR: ExportForm("Kalibr", "yaml", kalibr.written),
    System.ROS2: ExportForm("ROS 2", "yaml", ros2.written),
}
