"""A server of the dashboard in a process of its own."""

import contextlib
import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from pathlib import Path

import psutil

START_TIMEOUT_S = 240


def free_port() -> int:
    """Return a port on which nobody listens."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


class Server:
    """A running server."""

    def __init__(self, process: subprocess.Popen[bytes], port: int, path: str = "") -> None:
        self.process, self.port, self.path = process, port, path

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/{self.path}"

    @property
    def drive_url(self) -> str:
        """Where a page opens with Drive in sight."""
        return f"{self.url}?v=1&page=Drive"

    def get(self, path: str) -> str:
        """Return the body of an answer."""
        with urllib.request.urlopen(self.url + path, timeout=30) as answer:
            return str(answer.read().decode())

    def cpu_s(self) -> float:
        """Return the processor time used so far by all processes of the server [s]."""
        return sum(times.user + times.system for times in (one.cpu_times() for one in self.processes()))

    def processes(self) -> list[psutil.Process]:
        """Return the process that was started and those that it has started."""
        first = psutil.Process(self.process.pid)
        return [first, *first.children(recursive=True)]

    def wait(self, warm: bool = True) -> None:
        """Wait until the health check solves a scenario, or only until it answers."""
        deadline = time.monotonic() + START_TIMEOUT_S
        while time.monotonic() < deadline:
            if self.process.poll() is not None:
                raise RuntimeError(f"the server ended with status {self.process.returncode}")
            try:
                self.get("health")
                return
            except urllib.error.HTTPError:
                if not warm:
                    return
            except (urllib.error.URLError, ConnectionError, TimeoutError):
                pass
            time.sleep(0.2)
        raise RuntimeError(f"the server was not ready within {START_TIMEOUT_S} s")


@contextlib.contextmanager
def serving(
    *command: str,
    port: int | None = None,
    log: Path | None = None,
    environment: Mapping[str, str] | None = None,
    warm: bool = True,
    path: str = "",
) -> Iterator[Server]:
    """Run a command that takes --port, and end it afterwards.

    `log` takes what it writes down, `path` is the one below which it serves.
    """
    port = free_port() if port is None else port
    with contextlib.ExitStack() as stack:
        output = None if log is None else stack.enter_context(log.open("wb"))
        process = subprocess.Popen(
            [sys.executable, *command, "--port", str(port)],
            env={**os.environ, **(environment or {})},
            stdout=output,
            stderr=output,
        )
        server = Server(process, port, path)
        try:
            server.wait(warm)
            yield server
        finally:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
