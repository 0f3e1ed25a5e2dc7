"""A disk that forgets what was not synced: the system calls of a process, replayed up to any moment.

What is kept of a file are its bytes at its last fsync; of a folder the names at the folder's last fsync.
"""

import re
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

TRACED = "openat,write,pwrite64,fsync,fdatasync,ftruncate,rename,unlink,unlinkat,mkdir"
"""The calls that change files or make them durable, as `strace` names them."""
CALL = re.compile(r"^(\w+)\((.*)\)\s+= (-?\d+)(.*)$")
HANDLE = re.compile(r"^(\d+)<([^>]*)>")
TEXT = re.compile(r'"((?:\\x[0-9a-f]{2})*)"')

Left = tuple[tuple[str, bytes | None], ...]
"""Files by name with their bytes, and folders."""


@dataclass(frozen=True)
class Call:
    """One that succeeded."""

    name: str
    path: str
    """Path that it works on."""
    data: bytes = b""
    number: int = 0
    """Position of the write, or the new length."""
    other: str = ""
    """The new name."""


@dataclass
class Disk:
    """Names and bytes, as the process sees them and as the disk has them."""

    root: Path
    names: dict[str, int]
    written: dict[int, bytearray]
    synced_names: dict[str, int] = field(default_factory=dict)
    synced_bytes: dict[int, bytes] = field(default_factory=dict)

    @classmethod
    def of(cls, folder: Path) -> "Disk":
        """The disk with the content of a folder, all of it synced."""
        paths = sorted(folder.rglob("*"))
        names = {str(path): number for number, path in enumerate(paths)}
        content = {names[str(path)]: path.read_bytes() for path in paths if path.is_file()}
        return cls(folder, names, {n: bytearray(c) for n, c in content.items()}, dict(names), dict(content))

    def do(self, call: Call) -> None:
        """One call."""
        if call.name in ("openat", "mkdir"):
            self._make(call)
        elif call.name == "rename":
            self.names[call.other] = self.names.pop(call.path)
        elif call.name.startswith("unlink"):
            self.names.pop(call.path)
        elif call.name in ("fsync", "fdatasync"):
            self._sync(call.path)
        elif call.path in self.names:
            self._write(call)

    def _make(self, call: Call) -> None:
        if call.path not in self.names:
            self.names[call.path] = max([-1, *self.names.values(), *self.synced_names.values(), *self.written]) + 1
            if call.name == "openat":
                self.written[self.names[call.path]] = bytearray()

    def _write(self, call: Call) -> None:
        content = self.written[self.names[call.path]]
        if call.name == "ftruncate":
            content[:] = content[: call.number].ljust(call.number, b"\0")
            return
        place = len(content) if call.name == "write" else call.number
        content.extend(bytes(max(place - len(content), 0)))
        content[place : place + len(call.data)] = call.data

    def _sync(self, path: str) -> None:
        number = self.names.get(path)
        if number in self.written:
            self.synced_bytes[number] = bytes(self.written[number])
            return
        for names in (self.names, self.synced_names):
            for name in [n for n in names if str(Path(n).parent) == path]:
                if name in self.names:
                    self.synced_names[name] = self.names[name]
                else:
                    del self.synced_names[name]

    def left(self, *, names_kept: bool) -> Left:
        """Content after the power was cut; with ``names_kept`` the names got to the disk, the bytes did not."""
        names = self.names if names_kept else self.synced_names
        return tuple(
            (name, self.synced_bytes.get(number, b"") if number in self.written else None)
            for name, number in sorted(names.items())
        )

    def write(self, left: Left, folder: Path) -> None:
        """Puts it into a folder."""
        for name, content in left:
            place = folder / Path(name).relative_to(self.root)
            if not place.parent.is_dir():
                continue
            if content is None:
                place.mkdir()
            else:
                place.write_bytes(content)


def calls(trace: str, within: str) -> Iterator[Call]:
    """The calls of a trace that concern a folder, and what was written to standard output."""
    halves: dict[str, str] = {}
    for line in trace.splitlines():
        process, _, rest = line.partition(" ")
        rest = rest.strip()
        if rest.endswith("<unfinished ...>"):
            halves[process] = rest.removesuffix("<unfinished ...>").rstrip()
            continue
        resumed = re.match(r"<\.\.\. \w+ resumed>(.*)$", rest)
        found = CALL.match(halves.pop(process, "") + resumed[1] if resumed else rest)
        if found and int(found[3]) >= 0 and (call := _call(found)) and call.path.startswith((within, "pipe:")):
            yield call


def _call(found: re.Match[str]) -> Call | None:
    name, given, end = found[1], found[2], found[4]
    texts = [bytes.fromhex(text.replace("\\x", "")) for text in TEXT.findall(given)]
    if name == "openat":
        return Call(name, texts[0].decode()) if "O_CREAT" in given else None
    if name in ("mkdir", "rename", "unlink", "unlinkat"):
        return Call(name, texts[0].decode(), other=texts[-1].decode())
    handle = HANDLE.match(given)
    if handle is None:
        return None
    path = bytes.fromhex(handle[2].replace("\\x", "")).decode() if "\\x" in handle[2] else handle[2]
    last = given.rsplit(", ", 1)[-1]
    return Call(name, path, texts[0] if texts else b"", int(last) if last.isdigit() else 0, end)


def moments(disk: Disk, done: list[Call]) -> Iterator[tuple[int, Disk]]:
    """The disk before the first call and after each that changes what a power cut leaves."""
    yield 0, deepcopy(disk)
    for number, call in enumerate(done, 1):
        disk.do(call)
        if call.name not in ("write", "pwrite64", "ftruncate") or call.path.startswith("pipe:"):
            yield number, deepcopy(disk)
