"""Numbers and phases as people read them: narrow spaces for thousands, a true minus, a unit's usual digits."""

from collections.abc import Callable, Collection, Iterator, Sequence

from railjoule.core.advice import Instruction
from railjoule.core.phases import PhaseName
from railjoule.core.scenario import StrategyName
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

THIN_SPACE = "\u202f"
MINUS = "\u2212"
PER_MILLE = "\u2030"

STRATEGY_WORDS: dict[StrategyName, str] = {
    "optimal": "Optimal",
    "bellman": "Bellman",
    "eoc": "EOC",
    "enoc": "ENOC",
    "phases": "Phases",
    "speed_limits": "Speed limits",
    "fastest": "Fastest",
}
PHASE_WORDS: dict[PhaseName, str] = {
    "full_power": "full power",
    "part_power": "part power",
    "hold": "hold",
    "coast": "coast",
    "brake": "brake",
    "stand": "stand",
}
J_PER_WH = J_PER_KWH / 1000
SMALL_ENERGY_KWH = 5.0
SMALL_PRICE_WH_PER_S = 100.0
AT_START_M = 0.5
"""A phase that begins nearer to the start needs no place."""


def number(value: float, digits: int = 1) -> str:
    """Return a number with `digits` decimals, narrow spaces between thousands and a true minus."""
    text = f"{abs(value):,.{digits}f}".replace(",", THIN_SPACE)
    negative = value < 0 and any(character in "123456789" for character in text)
    return (MINUS if negative else "") + text


def decimals(value: float | None) -> int:
    """Return how many decimals a printed number has; 2 where none is printed."""
    if value is None:
        return 2
    text = repr(float(value)).partition(".")[2]
    return 0 if text == "0" else len(text)


def signed(value: float, digits: int = 1) -> str:
    """Return a difference: as `number`, with a plus where it is above zero."""
    text = number(value, digits)
    positive = not text.startswith(MINUS) and any(character in "123456789" for character in text)
    return ("+" if positive else "") + text


def energy(kwh: float) -> str:
    """Return an energy in kWh: two decimals, three below 5 kWh."""
    return number(kwh, 3 if abs(kwh) < SMALL_ENERGY_KWH else 2)


def price(watt: float) -> str:
    """Return a price of time [J/s] in Wh/s: whole, one decimal below 100."""
    wh_per_s = watt / J_PER_WH
    return number(wh_per_s, 1 if abs(wh_per_s) < SMALL_PRICE_WH_PER_S else 0)


def speed(ms: float, digits: int = 0) -> str:
    """Return a speed [m/s] in km/h."""
    return number(ms / MS_PER_KMH, digits)


def tenths(value: float, number: Callable[[float, int], str] = number) -> str:
    """Return a number as the advice has it: in tenths, whole where it is."""
    return number(value, 0 if value == round(value) else 1)


def advice_words(told: Instruction, number: Callable[[float, int], str] = number, named: Collection[float] = ()) -> str:
    """Return what a driver is told, such as 'full power to 36.9 km/h' or 'brake from 593 m to 50 km/h at 600 m'.

    Parameters
    ----------
    told : Instruction
        One line of the advice, whose numbers are printed as they are.
    number : callable
        Writes a number with its decimals.
    named : collection of float
        Places that are named beside it, and not told again [m].
    """

    def place(word: str, place_m: float | None) -> str:
        return "" if place_m is None or place_m in named else f" {word} {number(place_m, 0)} m"

    action = "brake fully" if told.fully else PHASE_WORDS[told.action]
    if told.action == "stand":
        return f"{action} {tenths(told.stand_s or 0.0, number)} s{place('at', told.from_m)}"
    start = place("from", told.from_m) if told.from_m >= AT_START_M else ""
    if told.action == "hold":
        return f"{action} {tenths(told.to_kmh or 0.0, number)} km/h{start}{_turns_words(told, number)}"
    if told.to_kmh is None:
        return f"{action}{start}" if start else "roll"
    aim = f"{tenths(told.to_kmh, number)} km/h" if told.to_kmh > 0 else "a stop"
    return f"{action}{start} to {aim}{place('at', told.at_m)}"


def advice_in_words(
    advice: Sequence[Instruction], number: Callable[[float, int], str] = number, named: Collection[float] = ()
) -> Iterator[str]:
    """Yield all that a driver is told; more of the same begins where it ended, and need not say so.

    Arguments as `advice_words`.
    """
    for before, told in zip((None, *advice), advice, strict=False):
        goes_on = before is not None and before.action == told.action and before.at_m == told.from_m
        yield advice_words(told, number, (*named, told.from_m) if goes_on else named)


def _turns_words(told: Instruction, number: Callable[[float, int], str]) -> str:
    """Return how a speed is held by turns; nothing where it just is."""
    if told.between_kmh is None:
        return ""
    low, high = (tenths(speed, number) for speed in told.between_kmh)
    share = told.power_share or 1.0
    power = "full power" if share == 1 else f"{100 * share:.0f} % power"
    return f" by turns: {power} to {high} km/h, coast to {low} km/h"
