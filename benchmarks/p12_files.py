"""P12: the heaviest files that are allowed, one of each format and four at once, sent to a running service.

Peak memory over idle of the service and all its processes, and the longest that `/healthz` took to answer meanwhile, as
in docs/security/files.md, where hostile files stand too (`python -m benchmarks.files`).
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.files.heavy import as_parquet, heaviest
from benchmarks.files.service import service

MEMORY, WAIT = 300.0, 0.5
"""MiB and s that are allowed."""

NOTE = """
P12 holds for hostile files too: [every one, with what it costs](../docs/security/files.md). Waiting is by the clock: on
a machine that does much else it shows that.
"""


def run() -> Iterator[Figure]:
    """Every format, then several at once; then the longest wait of all."""
    waits = []
    with (
        tempfile.TemporaryDirectory(prefix="imu-p12-") as folder,
        service(Path(folder), as_parquet("first")) as running,
    ):
        for name, make in heaviest():
            cost = running.cost(make())
            if set(cost.statuses) != {201}:
                raise AssertionError(f"{name} was answered {cost.statuses}: {cost.says}")
            waits.append(cost.wait)
            yield Figure(f"P12, {name}", "peak memory over idle", "limit", cost.memory, MEMORY, "≥ 1", "MiB")
    yield Figure("P12, waiting", "longest answer of /healthz meanwhile, by the clock", "limit", max(waits), WAIT, "≥ 1")
