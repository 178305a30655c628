"""`railjoule serve --processes N`: starts the processes behind one port."""

import asyncio
import multiprocessing
import os
import signal
import socket
from collections.abc import MutableSequence
from functools import partial
from multiprocessing.process import BaseProcess
from pathlib import Path

from railjoule.core.compilation import compilation
from railjoule.core.kernel_cache import has_all_kernels
from railjoule.dashboard.scenario_folder import ScenarioFolder
from railjoule.dashboard.server.front import Front
from railjoule.dashboard.server.logs import warn_without_login, write_down
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.server.places import NUMBERS
from railjoule.dashboard.work.offered import new_folder

# a fork would copy the threads' locks without the threads
CONTEXT = multiprocessing.get_context("spawn")


def serve_in_processes(options: ServerOptions, own: ScenarioFolder | None) -> None:
    """Serve the dashboard in several processes until a signal ends them.

    Raises
    ------
    OSError
        If the address cannot be listened at.
    """
    write_down()
    warn_without_login(options)
    shared: MutableSequence[int] = CONTEXT.RawArray("i", NUMBERS * options.processes)
    front = Front(options, partial(_started, options, own, new_folder()), shared, has_all_kernels)
    print(f"Launching {options.processes} processes at http://{options.address}:{options.port}{options.prefix}")
    ended_by = asyncio.run(front.run())
    if ended_by == signal.SIGINT:
        raise KeyboardInterrupt
    # whoever has started this program sees by what it was ended, as with one process
    signal.signal(ended_by, signal.SIG_DFL)
    os.kill(os.getpid(), ended_by)


def _started(
    options: ServerOptions,
    own: ScenarioFolder | None,
    folder: Path,
    number: int,
    channel: socket.socket,
    shared: MutableSequence[int],
) -> BaseProcess:
    process = CONTEXT.Process(target=_serve, args=(options, own, number, channel, shared, folder), daemon=False)
    process.start()
    return process


def _serve(
    options: ServerOptions,
    own: ScenarioFolder | None,
    number: int,
    channel: socket.socket,
    shared: MutableSequence[int],
    folder: Path,
) -> None:
    """Serve in a process of its own what it is handed."""
    # the terminal sends it to all; the process before them ends the others
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    compilation().begin()
    from railjoule.dashboard import app  # noqa: PLC0415

    app.serve_handed(options, own, number, channel, shared, folder)
