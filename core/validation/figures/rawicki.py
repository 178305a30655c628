"""Printed figures of Rawicki 2013, rebuilt."""

from railjoule.core.validation.figure import PaperFigure

FIGURES: tuple[PaperFigure, ...] = ()
"""In the order of the paper."""
