"""`imu-health` without its second of imports: a process that has every command loaded forks for each call.

What a fork runs is `service.cli.main` with the caller's arguments, folder, variables and handles: to a shell it is the
command itself, in pipes and conditions too.
"""

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

from service.cli import main as imu_health
from service.commands.catalogue import CATALOGUE

CLIENT = """#!{python} -IS
import json, os, socket, sys
with socket.socket(socket.AF_UNIX) as way:
    way.connect({address!r})
    socket.send_fds(way, [b"."], [0, 1, 2])
    call = json.dumps([sys.argv, os.getcwd(), dict(os.environ)]).encode()
    way.sendall(len(call).to_bytes(8, "big") + call)
    sys.exit(way.recv(1)[0])
"""
"""The command in the shell's path; it imports nothing of ours."""


def main() -> None:
    """Fork for every call that comes, until the one who started this ends it."""
    for entry in CATALOGUE.values():
        import_module(f"service.commands.{entry.home.partition('.')[0]}")
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(sys.argv[1])
        door.listen()
        print("ready", flush=True)
        while True:
            way, _ = door.accept()
            if os.fork() == 0:
                _answer(way)
            way.close()


def _answer(way: socket.socket) -> None:
    """Becomes the command in the fork, and sends its exit code."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    _, handles, _, _ = socket.recv_fds(way, 1, 3)
    for place, handle in enumerate(handles):
        os.dup2(handle, place)
    with way.makefile("rb") as said:
        sys.argv, folder, variables = json.loads(said.read(int.from_bytes(said.read(8), "big")))
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(variables)
    code = 1
    try:
        imu_health()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        way.sendall(bytes([code]))
        os._exit(code)


@contextmanager
def preloaded(folder: Path) -> Iterator[Path]:
    """A folder to put first into a shell's path: its `imu-health` starts in milliseconds."""
    client, address = folder / "imu-health", str(folder / "calls")
    client.write_text(CLIENT.format(python=sys.executable, address=address), "utf-8")
    client.chmod(0o755)
    command = [sys.executable, "-m", "tests.docs.preloaded", address]
    with subprocess.Popen(command, cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            yield folder
        finally:
            process.terminate()


if __name__ == "__main__":
    main()
