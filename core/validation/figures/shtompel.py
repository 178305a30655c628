"""Printed figures of Shtompel 2025, rebuilt."""

from railjoule.core.validation.figure import PaperFigure

FIGURES: tuple[PaperFigure, ...] = ()
"""In the order of the paper."""
