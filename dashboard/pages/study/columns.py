"""The columns of a study: what varies and what came out, with their units and how their numbers read."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.studies.sweep import Study
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.study.compute import RESULTS
from railjoule.dashboard.pages.study.fields import fields_that_vary


@dataclass(frozen=True)
class Column:
    """A column of a study: quantity and unit, how a number of it reads, and what it is multiplied by for that unit."""

    name: str
    words: str
    digits: int | None
    scale: float = 1.0

    @property
    def quantity(self) -> str:
        """The quantity alone."""
        return self.words.rpartition(", ")[0]

    @property
    def unit(self) -> str:
        """The unit alone; empty where there is none."""
        unit = self.words.rpartition(", ")[2]
        return "" if unit == words.UNKNOWN else unit

    @property
    def within_sentence(self) -> str:
        """The quantity as within a sentence."""
        name = self.quantity
        return name[:1].lower() + name[1:]

    def show(self, number: float) -> str:
        """Return how a number in the shown unit reads."""
        return RESULTS[self.name].show(number) if self.digits is None else words.number(number, self.digits)

    def told(self, number: float) -> str:
        """Return a number with its unit."""
        return f"{self.show(number)} {self.unit}".rstrip()


def columns_of(study: Study) -> dict[str, Column]:
    """Return the columns of a study: what varies, then what came out."""
    known = fields_that_vary(study.scenario)
    found = {}
    for field in study.fields:
        label = known[field.name].label if field.name in known else f"{field.name}, {words.UNKNOWN}"
        found[field.name] = Column(field.name, label, 0 if field.whole else digits_for(field.high - field.low))
    return found | {name: Column(name, RESULTS[name].words, None, RESULTS[name].scale) for name in study.columns}


def digits_for(span: float) -> int:
    """Return the decimals that tell two hundredths of a span apart."""
    return int(np.clip(np.ceil(-np.log10(span / 200)), 0, 9)) if span > 0 else 2
