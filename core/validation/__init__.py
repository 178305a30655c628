"""The papers' printed numbers and claims with those of railjoule, and other solvers with its own."""

from collections.abc import Callable
from functools import partial

from railjoule.core.validation import ftorek, liashenko, rawicki, shtompel
from railjoule.core.validation.figures.ftorek import FIGURES as FTOREK_FIGURES
from railjoule.core.validation.figures.liashenko import FIGURES as LIASHENKO_FIGURES
from railjoule.core.validation.figures.rawicki import FIGURES as RAWICKI_FIGURES
from railjoule.core.validation.figures.shtompel import FIGURES as SHTOMPEL_FIGURES
from railjoule.core.validation.papers import compare
from railjoule.core.validation.table import Claim, Comparison, Erratum, Row, Table, Validation, first_comparisons

COMPARISONS: dict[str, Callable[[], Comparison]] = {
    "ftorek": partial(compare, "ftorek-2025", ftorek, FTOREK_FIGURES),
    "liashenko": partial(compare, "liashenko-2025", liashenko, LIASHENKO_FIGURES),
    "rawicki": partial(compare, "rawicki-2013", rawicki, RAWICKI_FIGURES),
    "shtompel": partial(compare, "shtompel-2025", shtompel, SHTOMPEL_FIGURES),
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
