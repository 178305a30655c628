"""Claims of Rawicki 2013, examined."""

from railjoule.core.validation.claim import Examinations

EXAMINATIONS: Examinations = {}
"""The examination of each claim, by its name in the paper's file."""
