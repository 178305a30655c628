"""Printed figures of Liashenko 2025, rebuilt."""

from railjoule.core.validation.figure import PaperFigure

FIGURES: tuple[PaperFigure, ...] = ()
"""In the order of the paper."""
