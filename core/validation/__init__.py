"""The papers' printed numbers beside ours, and other solvers beside ours."""

from collections.abc import Callable

from railjoule.core.validation.ftorek import validate_ftorek
from railjoule.core.validation.liashenko import validate_liashenko
from railjoule.core.validation.rawicki import validate_rawicki
from railjoule.core.validation.shtompel import validate_shtompel
from railjoule.core.validation.table import Erratum, Row, Table, Validation

PAPERS: dict[str, Callable[[], Validation]] = {
    "ftorek": validate_ftorek,
    "liashenko": validate_liashenko,
    "rawicki": validate_rawicki,
    "shtompel": validate_shtompel,
}
"""What `railjoule validate` knows, by its name there."""

__all__ = [
    "PAPERS",
    "Erratum",
    "Row",
    "Table",
    "Validation",
    "validate_ftorek",
    "validate_liashenko",
    "validate_rawicki",
    "validate_shtompel",
]
