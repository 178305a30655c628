"""The papers' printed numbers and claims with those of railjoule, and other solvers with its own."""

from collections.abc import Callable
from functools import partial

from railjoule.core.validation import ftorek, liashenko, rawicki, shtompel
from railjoule.core.validation.figures import ftorek as ftorek_figures
from railjoule.core.validation.figures import liashenko as liashenko_figures
from railjoule.core.validation.figures import rawicki as rawicki_figures
from railjoule.core.validation.figures import shtompel as shtompel_figures
from railjoule.core.validation.papers import compare
from railjoule.core.validation.table import Claim, Comparison, Erratum, Row, Table, Validation, first_comparisons

COMPARISONS: dict[str, Callable[[], Comparison]] = {
    "ftorek": partial(compare, "ftorek-2025", ftorek, ftorek_figures),
    "liashenko": partial(compare, "liashenko-2025", liashenko, liashenko_figures),
    "rawicki": partial(compare, "rawicki-2013", rawicki, rawicki_figures),
    "shtompel": partial(compare, "shtompel-2025", shtompel, shtompel_figures),
}
"""The comparison of each paper, not computed yet, by its name in `railjoule validate`."""

PAPERS: dict[str, Callable[[], Validation]] = {
    name: lambda comparison=comparison: comparison().validation()  # type: ignore[misc]
    for name, comparison in COMPARISONS.items()
}
"""The whole comparison of each paper, by the same names."""

__all__ = [
    "COMPARISONS",
    "PAPERS",
    "Claim",
    "Comparison",
    "Erratum",
    "Row",
    "Table",
    "Validation",
    "first_comparisons",
]
