"""What a benchmark says: a number beside the bar that it is held to."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Measurement:
    """One measured number.

    Parameters
    ----------
    name : str
        What was measured.
    value : float
        The number.
    unit : str
        Its unit.
    at_most, at_least : float or None
        The bar; None where the number only informs.
    """

    name: str
    value: float
    unit: str
    at_most: float | None = None
    at_least: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the number keeps its bar."""
        over = self.at_most is not None and not self.value <= self.at_most
        under = self.at_least is not None and not self.value >= self.at_least
        return not (over or under)

    @property
    def bar(self) -> str:
        """The bar in words."""
        if self.at_most is not None:
            return f"at most {self.at_most:,g}"
        return "" if self.at_least is None else f"at least {self.at_least:,g}"

    @property
    def missed(self) -> bool:
        """Whether there is a bar that the number misses."""
        return not self.holds

    @property
    def line(self) -> str:
        """The number as a row of a table."""
        verdict = "" if not self.bar else "holds" if self.holds else "MISSED"
        return f"{self.name:62}{self.value:12,.3g} {self.unit:10} {self.bar:16} {verdict}"
