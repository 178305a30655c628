"""Compile all kernels on a machine's first start, in processes beside the one that computes."""

from railjoule.core.compilation.background import KERNELS, Compilation, compilation, require_compiled
from railjoule.core.compilation.light import needs_compiler

__all__ = ["KERNELS", "Compilation", "compilation", "needs_compiler", "require_compiled"]
