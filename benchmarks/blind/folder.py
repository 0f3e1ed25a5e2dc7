"""The folder that is given away, and the secret that stays behind.

The generator is open, so truths are sealed by the seed alone: 128 random bits, kept in a file apart. The folder holds
the SHA-256 of that file. Nobody can guess the seed from it, and nobody can put another one in its place later.
"""

import json
import secrets
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from hashlib import sha256
from math import isclose
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.study.examine import SHARES
from tests.blind.case import Case
from tests.blind.cases import draw_case

MANIFEST, SESSION = "benchmark.json", "session.json"
FORMAT, SECRET = "imu-blind-benchmark/1", "imu-blind-secret/1"
SAME = 1e-9
"""Relative: another build of the linear algebra moves the last digits of a reading."""


@dataclass(frozen=True)
class Secret:
    """The secret that all truths follow from."""

    seed: int
    sessions: int
    sound: bool = False
    """Whether no session has an effect: such a folder sets thresholds."""

    @property
    def content(self) -> bytes:
        """Content of its file."""
        document = {"format": SECRET, "seed": f"{self.seed:x}", "sessions": self.sessions}
        return json.dumps(document | ({"sound": True} if self.sound else {})).encode()

    @property
    def commitment(self) -> str:
        """The published commitment to it."""
        return sha256(self.content).hexdigest()

    def cases(self) -> Iterator[tuple[str, Case]]:
        """Every session by its number, with its truth."""
        kinds = np.random.default_rng(self.seed).choice(list(SHARES), size=self.sessions, p=list(SHARES.values()))
        for number, kind in enumerate(kinds, 1):
            yield f"{number:05}", draw_case("none" if self.sound else str(kind), (self.seed, number))


def drawn(sessions: int, seed: int | None, *, sound: bool = False) -> Secret:
    """A secret; a stated seed is none, and makes a benchmark that everybody can mark."""
    return Secret(secrets.randbits(128) if seed is None else seed, sessions, sound)


def read_secret(file: Path, folder: Path) -> Secret:
    """The secret of a folder; ValueError where the folder was made of another one."""
    document = json.loads(file.read_text("utf-8"))
    secret = Secret(int(document["seed"], 16), document["sessions"], document.get("sound", False))
    stated = json.loads((folder / MANIFEST).read_text("utf-8"))["commitment"]
    if secret.commitment != stated:
        raise ValueError(f"{file} is not the secret of {folder}: SHA-256 {secret.commitment}, published {stated}")
    return secret


def write(folder: Path, secret: Secret) -> Iterator[str]:
    """Writes every session with its history, numbers as they are written, and the manifest last."""
    for number, case in secret.cases():
        own = folder / number
        own.mkdir(parents=True)
        for name, document in files_of(case):
            (own / name).write_text(json.dumps(document), "utf-8")
        yield number
    manifest = {"format": FORMAT, "sessions": secret.sessions, "commitment": secret.commitment}
    (folder / MANIFEST).write_text(json.dumps(manifest, indent=1), "utf-8")


def files_of(case: Case) -> Iterator[tuple[str, dict[str, Any]]]:
    """The session, and the unit's earlier ones, oldest first."""
    yield SESSION, case.session
    for number, earlier in enumerate(case.history, 1):
        yield f"history-{number}.json", earlier


def numbers(folder: Path) -> list[str]:
    """Numbers of the sessions in a folder."""
    return sorted(path.parent.name for path in folder.glob(f"*/{SESSION}"))


def require_same(folder: Path, number: str, case: Case) -> None:
    """ValueError where a file is not the one that the secret gives."""
    for name, document in files_of(case):
        if not _same(json.loads((folder / number / name).read_text("utf-8")), document):
            raise ValueError(f"{folder / number / name} is not the file that the secret gives")


def _same(one: Any, other: Any) -> bool:
    match one, other:
        case dict(), dict():
            return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
        case list(), list():
            return len(one) == len(other) and all(map(_same, one, other))
        case float(), float():
            return isclose(one, other, rel_tol=SAME, abs_tol=1e-15)
    return bool(one == other)


@dataclass(frozen=True)
class Answers:
    """Answers of one entrant to every session."""

    by: str
    answers: dict[str, dict[str, Any]]
    """Answers by number: ``findings`` and ``unexplained`` as in imu-diagnosis/1."""

    def write(self, file: Path) -> None:
        """Writes the answers to a file."""
        file.write_text(json.dumps({"format": "imu-blind-answers/1", **asdict(self)}), "utf-8")


def read_answers(file: Path) -> Answers:
    """Reads answers from a file."""
    document = json.loads(file.read_text("utf-8"))
    return Answers(document["by"], document["answers"])
