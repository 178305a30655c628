"""The papers' printed numbers beside ours, and other solvers beside ours."""

from collections.abc import Callable

from railjoule.core.validation.claim import Claim
from railjoule.core.validation.ftorek import ftorek_comparison, validate_ftorek
from railjoule.core.validation.liashenko import liashenko_comparison, validate_liashenko
from railjoule.core.validation.rawicki import rawicki_comparison, validate_rawicki
from railjoule.core.validation.shtompel import shtompel_comparison, validate_shtompel
from railjoule.core.validation.table import Comparison, Erratum, Row, Table, Validation, first_comparisons

PAPERS: dict[str, Callable[[], Validation]] = {
    "ftorek": validate_ftorek,
    "liashenko": validate_liashenko,
    "rawicki": validate_rawicki,
    "shtompel": validate_shtompel,
}
"""What `railjoule validate` knows, by its name there."""

COMPARISONS: dict[str, Callable[[], Comparison]] = {
    "ftorek": ftorek_comparison,
    "liashenko": liashenko_comparison,
    "rawicki": rawicki_comparison,
    "shtompel": shtompel_comparison,
}
"""The same, to be computed table by table."""

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
    "validate_ftorek",
    "validate_liashenko",
    "validate_rawicki",
    "validate_shtompel",
]
