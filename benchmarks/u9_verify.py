"""U9: `imu-health verify` of a sealed certificate beside its session's and its reference's files, from its start to its
end, by the clock; and how many of two hundred certificates with one thing changed pass."""

import statistics
import tempfile
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx

from benchmarks.figures import Felt, start
from benchmarks.p10_startup import COMMAND
from benchmarks.u2_uploads import serving
from service.papers.sealing import seal_of
from service.papers.verifying.records import Outcome, RawFile
from service.papers.verifying.verify import Beside, verify
from tests.service.made_sessions import FAILED
from tests.service.papers.mutations import mutated
from tests.service.papers.trial_key import trial_key

ROUNDS, MUTATIONS = 5, 200
LIMIT = 5.0
"""s."""
TRUSTED = b"-----BEGIN CERTIFICATE"


def run() -> Iterator[Felt]:
    """The command, then the changed ones in this process."""
    with tempfile.TemporaryDirectory(prefix="imu-u9-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        key = folder / "seal.pem"
        key.write_bytes(trial_key("U9", datetime.now(UTC)))
        seal = seal_of(key, None)
        assert seal is not None
        sealed, trusted = seal.xml(certificate(name)), TRUSTED + key.read_bytes().split(TRUSTED)[1]
        files = {"c.xml": sealed, "s.json": FAILED[-1], "r.json": FAILED[0], "t.pem": trusted}
        for file, content in files.items():
            (folder / file).write_bytes(content)
        c, s, r, t = (str(folder / file) for file in files)
        taken = command(c, s, "--reference", r, "--trust", t)
        yield Felt("U9", "a certificate recomputed from its session's file", taken, LIMIT, "s")
    passed = 0
    for seed in range(MUTATIONS):
        given = Beside(trusted=trusted) if seed % 2 else Beside()
        found = verify(mutated(sealed, seed), RawFile("s.json", FAILED[-1]), given, datetime.now(UTC))
        passed += found.outcome is not Outcome.DIFFERS
    yield Felt("U9, changed", f"certificates with one thing changed that pass, of {MUTATIONS}", passed, 0, "")


def certificate(folder: str) -> bytes:
    """The certificate of a session that is out of tolerance."""
    with serving(folder) as port, httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=120) as http:
        for content in FAILED:
            receipt = http.post("/sessions", content=content).raise_for_status().json()
        answer = http.get(f"/sessions/{receipt['id']}/certificate", params={"format": "dcc"})
        return answer.raise_for_status().content


def command(*arguments: str) -> float:
    """Seconds of the whole command; the first one compiles what is not compiled yet."""
    taken = []
    for _ in range(1 + ROUNDS):
        began = time.monotonic()
        start(COMMAND, "verify", *arguments)
        taken.append(time.monotonic() - began)
    return statistics.median(taken[1:])
