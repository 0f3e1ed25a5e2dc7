"""P10: how long a command takes from its start to its end, against Python that imports numpy and scipy and ends.

Both are processes of their own, started in turn, from compiled files as an installation has them; the first round
compiles what is not compiled yet and is not measured. The session is that of P1, its calibration printed as a table.
"""

import json
import sys
import tempfile
from functools import partial
from pathlib import Path

from benchmarks.block import sessions
from benchmarks.figures import IMPORTS, Figure, children, side_by_side, start
from estimator.writing import session_document

ROUNDS = 20
COMMAND = str(Path(sys.executable).with_name("imu-health"))
NEEDED = "import numpy, scipy.special, typer, rich.progress, rich.table; from pydantic import TypeAdapter"
LIBRARIES = (sys.executable, "-c", NEEDED)
"""The least that a command needs which calibrates and prints a table; Typer reads arguments by pydantic."""
NOTE = """
P10 misses its second target by its libraries. The peer imports numpy and of scipy only the name. A calibration needs
scipy's special functions, for probabilities and coverage factors, a third of the time: their import loads all of numpy
too, its Fortran wrapper among it. Arguments are read by Typer, which reads them by pydantic, another quarter, and rich
draws the table. These alone, imported and left, take more than three times as long as the peer. Own modules are a
fifteenth, reading and calibrating a hundredth.
"""


def run() -> list[Figure]:
    """The list of commands, the command that needs least, and what bounds it."""
    with tempfile.TemporaryDirectory(prefix="imu-p10-") as folder:
        file = Path(folder) / "session.json"
        file.write_text(json.dumps(session_document(sessions(1)[0])), encoding="utf-8")
        calibrate = ("calibrate", str(file))
        rows = (
            ("P10, help", ("--help",), IMPORTS, "python -c 'import numpy, scipy'", "≥ 1"),
            ("P10, calibrate", calibrate, IMPORTS, "python -c 'import numpy, scipy'", "at least 1/2"),
            ("P10, libraries", calibrate, LIBRARIES, "python that imports its libraries and ends", "—"),
        )
        figures = []
        for name, arguments, peer, described, target in rows:
            ours, theirs = partial(start, COMMAND, *arguments), partial(start, *peer)
            times = side_by_side(ours, theirs, ROUNDS, clock=children)
            shown = "imu-health --help" if arguments == ("--help",) else "imu-health calibrate FILE"
            figures.append(Figure(name, shown, described, *times, target))
        return figures
