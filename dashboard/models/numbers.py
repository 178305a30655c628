"""Numbers as people type them."""

import math

import param

from railjoule.dashboard.models.kept import Kept


def parse_number(text: str, bounds: tuple[float | None, float | None]) -> float:
    """Return the number that a text gives.

    Raises
    ------
    ValueError
        With a sentence that names the bound that it misses.
    """
    try:
        value = float(text.replace("\u202f", "").replace("\u2212", "-").replace(",", "."))
    except ValueError:
        raise ValueError("Not a number.") from None
    if not math.isfinite(value):
        raise ValueError("Not a number.")
    low, high = bounds
    if low is not None and value < low:
        raise ValueError(f"At least {low:g}.")
    if high is not None and value > high:
        raise ValueError(f"At most {high:g}.")
    return value


class TypedParameters(Kept):
    """Parameters whose numbers can be typed."""

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives for a field.

        Raises
        ------
        ValueError
            With a sentence that names the bound that it misses.
        """
        number = parse_number(text, self.bounds_of(field))
        if not isinstance(self.param[field], param.Integer):
            return number
        if number != int(number):
            raise ValueError("A whole number.")
        return int(number)
