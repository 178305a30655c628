"""Shtompel, Khvorost 2025: tables of ratios and signs, and the verdicts on the paper's claims."""

from railjoule.core.validation.claim import list_claims
from railjoule.core.validation.claims.shtompel import EXAMINATIONS
from railjoule.core.validation.figures.shtompel import FIGURES
from railjoule.core.validation.papers import citation, errata, printed_numbers
from railjoule.core.validation.shtompel_rows import (
    costs,
    efficiency,
    evaluations,
    literal_braking,
    near_full_effort,
    near_full_power,
    regenerative_stop,
    spread,
    storage_sizes,
)
from railjoule.core.validation.table import Comparison, Table, Validation


def validate_shtompel() -> Validation:
    """Return the paper's claims beside numbers of the assumed train and line."""
    return shtompel_comparison().validation()


def shtompel_comparison() -> Comparison:
    """Return what is to be compared of Shtompel, Khvorost 2025."""
    paper = printed_numbers("shtompel-2025")
    return Comparison(
        paper="shtompel",
        citation=citation(paper),
        tables=(
            lambda: Table("Efficiency of motor and drive", efficiency(), "Fig. 1"),
            lambda: Table("Evaluations of the objective function", evaluations(), "below (16)"),
            lambda: Table("Traction at full effort", near_full_effort(), "conclusion 2"),
            lambda: Table("Recuperation in stopping", regenerative_stop(), "conclusion 2"),
            lambda: Table("Storage for the largest reduction of the energy consumed", storage_sizes(), "conclusion 2"),
            lambda: Table("Power of the drive, at most 2199 kW", near_full_power(), "conclusion 3"),
            lambda: Table("Extra energy of set speeds over the optimum in the same time", costs()),
            lambda: Table("The printed regulator depends on its time step", spread()),
            lambda: Table("Braking by (8) and (9) as they are printed", literal_braking()),
        ),
        errata=errata(paper),
        claims=list_claims(paper, EXAMINATIONS),
        figures=FIGURES,
    )
