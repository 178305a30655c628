"""A process that compiles the parts whose names it reads, a line each, and prints a line for each kernel and part."""

import os
import queue
import sys
import threading
from typing import Any

from numba.core import event

from railjoule.core.compilation.order import KERNEL_LINE, PART_LINE
from railjoule.core.compilation.parts import PARTS
from railjoule.core.compiled import MODE

NICENESS = 10
"""Where cores are short, the process that computes goes first."""


class _PrintKernels(event.Listener):
    """Prints a line for each kernel that has been compiled."""

    def on_start(self, _event: object) -> None:
        """Do nothing."""

    def on_end(self, _event: object) -> None:
        """Print the line."""
        print(KERNEL_LINE, flush=True)


def main() -> None:
    """Compile parts until the other end of the pipe is closed, then end at once."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    MODE.is_compiled = True
    due: queue.Queue[Any] = queue.Queue()

    def read() -> None:
        for line in sys.stdin:
            due.put(line.strip())
        # in the middle of a part too: the process that asked has ended
        os._exit(0)

    threading.Thread(target=read, daemon=True).start()
    with event.install_listener("numba:compile", _PrintKernels()):
        while True:
            PARTS[due.get()]()
            print(PART_LINE, flush=True)


if __name__ == "__main__":
    main()
