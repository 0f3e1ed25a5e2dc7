"""``python -m benchmarks.fuzz --seconds 60`` looks for files that are neither read nor refused.

With atheris (``pip install atheris``, Linux) mutations are guided by the code of the readers that they reach: text, and
the look through a workbook, in this process; every fiftieth file also by the process apart, as the service does.
Without it hypothesis damages the same files at random.
"""

import argparse
import importlib
import importlib.util
import os
import random
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz.corpus import corpus
from estimator.errors import SessionError
from estimator.reading import read_session
from service.ingest import apart_session
from service.ingest.formats import XLSX, is_binary
from service.ingest.xlsx import check_workbook

GUIDED = ("estimator.reading", "service.ingest.xlsx", "service.ingest.metadata")
"""Packages whose branches guide the mutations."""
APART_EVERY = 50
"""Files of which one is also read by the process apart: a fork takes a hundred times as long."""


def read_or_refused(content: bytes, *, apart: bool) -> None:
    """Anything else than a session or a refusal with a reason is a find."""
    refusal = None
    try:
        if content.startswith(XLSX):
            check_workbook(content, "file")
        if apart:
            apart_session(content, "file")
        elif not is_binary(content):
            read_session(content)
    except SessionError as error:
        refusal = error
    assert refusal is None or refusal.problems
    str(refusal).encode()


def main() -> None:
    """Look for so long, and say how many files were tried."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for what is found and learned")
    options = parser.parse_args()
    known = corpus()
    for content in known.values():
        read_or_refused(content, apart=True)
    if importlib.util.find_spec("atheris") is None:
        _at_random(list(known.values()), options.seconds, options.seed)
        return
    with TemporaryDirectory() as own:
        folder = options.keep or Path(own)
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in known.items():
            (folder / name).write_bytes(content)
        _guided(folder, options.seconds, options.seed)


def _guided(folder: Path, seconds: int, seed: int) -> None:
    atheris = importlib.import_module("atheris")
    for name, module in list(sys.modules.items()):
        if name.startswith(GUIDED):
            _instrument(atheris.instrument_func, module)
    tried = 0

    def one(content: bytes) -> None:
        nonlocal tried
        tried += 1
        read_or_refused(content, apart=tried % APART_EVERY == 0)

    limits = [f"-max_total_time={seconds}", f"-seed={seed}", "-max_len=20000", "-timeout=60", "-rss_limit_mb=2048"]
    atheris.Setup([sys.argv[0], *limits, f"-artifact_prefix={folder}/", str(folder)], one)
    atheris.Fuzz()


def _instrument(instrument: Callable[[object], object], module: object) -> None:
    """The functions and methods of a module, in place."""
    functions = [own for own in vars(module).values() if getattr(own, "__module__", "") == vars(module)["__name__"]]
    methods = [m for own in functions if isinstance(own, type) for m in vars(own).values()]
    for function in (*functions, *methods):
        if hasattr(function, "__code__"):
            instrument(function)


def _at_random(known: list[bytes], seconds: int, seed: int) -> None:
    end, tried = time.monotonic() + seconds, 0

    @settings(max_examples=100, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(content=st.sampled_from(known), data=st.data())
    def batch(content: bytes, data: st.DataObject) -> None:
        nonlocal tried
        changed = bytearray(content)
        for _ in range(data.draw(st.integers(1, 6))):
            at = data.draw(st.integers(0, len(changed)))
            changed[at : at + data.draw(st.integers(0, 8))] = data.draw(st.binary(max_size=8))
        tried += 1
        read_or_refused(bytes(changed), apart=True)

    random.seed(seed)
    while time.monotonic() < end:
        batch()
    print(f"{tried} files in {seconds} s: each was read, or refused with a reason")


if __name__ == "__main__":
    main()
