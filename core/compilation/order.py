"""The order in which helper processes take the parts, and the lines that they print."""

from typing import Literal, get_args

Part = Literal[
    "solver",
    "fastest",
    "proof",
    "limits",
    "bellman",
    "optimum",
    "switching",
    "metro",
    "regulators",
    "closed_loop",
    "simple_advice",
    "following",
    "maps",
    "phases",
    "enoc",
]
"""A part of the kernels. The first ones take longest, and two that share kernels do not follow each other."""
PARTS_IN_ORDER: tuple[Part, ...] = get_args(Part)
KERNEL_LINE, PART_LINE = "kernel", "part"
"""What a helper prints for each kernel and each part that it has compiled."""
HELPER = "railjoule.core.compilation.helper"
"""The module that a helper process runs."""
