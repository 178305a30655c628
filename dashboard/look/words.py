"""Numbers and phases as people read them: narrow spaces for thousands, a true minus, a unit's usual digits.

Each quantity has one function here, so that it reads alike on every page, in charts, in reports and, made plain, in a
terminal. How runs compare is told in `railjoule.dashboard.look.comparisons`.
"""

import math
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

from railjoule.core.energy import energy_decimals
from railjoule.core.phases import Phase, PhaseName
from railjoule.core.scenario import StrategyName
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

THIN_SPACE = "\u202f"
MINUS = "\u2212"
PER_MILLE = "\u2030"
UNKNOWN = "\u2013"
PLAIN_SIGNS = str.maketrans({THIN_SPACE: ",", MINUS: "-", UNKNOWN: "-"})
"""What a terminal shows for them."""

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
LEAST_ENERGY_KWH = 5e-4
"""An energy below this reads as zero."""
SMALL_PRICE_WH_PER_S = 100.0
SHORT_TIME_S = 10.0
AT_START_M = 0.5
"""A phase that begins nearer to the start needs no place."""


P = ParamSpec("P")


def plain_text(text: str) -> str:
    """Return a number as a terminal shows it: with commas between thousands and a hyphen for a minus."""
    return text.translate(PLAIN_SIGNS)


def plain(show: Callable[P, str]) -> Callable[P, str]:
    """Return a function that writes numbers as one that writes them for a terminal."""

    @wraps(show)
    def shown(*args: P.args, **kwargs: P.kwargs) -> str:
        return plain_text(show(*args, **kwargs))

    return shown


def number(value: float, digits: int = 1) -> str:
    """Return a number with `digits` decimals, narrow spaces between thousands and a true minus; a dash for NaN."""
    if not math.isfinite(value):
        return UNKNOWN
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
    return number(kwh, energy_decimals(kwh))


def energy_difference(kwh: float) -> str:
    """Return a difference of energies in kWh: as `energy`, with its sign."""
    return signed(kwh, energy_decimals(kwh))


def share(value: float) -> str:
    """Return a share in percent, as 7.0 for 0.07: one decimal, two below 1 %, none from 100 % on."""
    return number(100 * value, percent_decimals(100 * value))


def share_difference(value: float) -> str:
    """Return a relative difference in percent: as `share`, with its sign."""
    return signed(100 * value, percent_decimals(100 * value))


def percent_decimals(percent: float) -> int:
    """Return with how many decimals a percentage is printed."""
    return 2 if abs(percent) < 0.995 else 1 if abs(percent) < 99.95 else 0


def setting(factor: float) -> str:
    """Return a share that was set, such as a load, in percent: whole unless it was set finer."""
    return number(100 * factor, 0 if abs(100 * factor - round(100 * factor)) < 0.05 else 1)


def distance(metres: float) -> str:
    """Return the length of a run or a line in km: two decimals."""
    return number(metres / 1000, 2)


def time(seconds: float) -> str:
    """Return a time in s: one decimal."""
    return number(seconds, 1)


def delay(seconds: float) -> str:
    """Return a difference of times in s: as `time`, with its sign; early is negative."""
    return signed(seconds, 1)


def stop_error(metres: float) -> str:
    """Return how far beyond its place a train stands in m: two decimals, with its sign."""
    return signed(metres, 2)


def price(watt: float) -> str:
    """Return a price of time [J/s] in Wh/s: whole, one decimal below 100."""
    wh_per_s = watt / J_PER_WH
    return number(wh_per_s, 1 if abs(wh_per_s) < SMALL_PRICE_WH_PER_S else 0)


def load(factor: float) -> str:
    """Return how full a vehicle is, such as 'load 50 %' or 'crush load, 120 % of capacity'."""
    return f"crush load, {setting(factor)} % of capacity" if factor > 1 else f"load {setting(factor)} %"


def strategy(name: str) -> str:
    """Return what a strategy is called."""
    return STRATEGY_WORDS[name]  # type: ignore[index]


def speed(ms: float, digits: int = 0) -> str:
    """Return a speed [m/s] in km/h."""
    return number(ms / MS_PER_KMH, digits)


def phase_words(phase: Phase) -> str:
    """Return what the driver does in a phase, such as 'full power to 38 km/h'."""
    if phase.phase in {"full_power", "part_power"}:
        return f"{PHASE_WORDS[phase.phase]} to {speed(phase.end_ms)} km/h"
    if phase.phase == "hold":
        return f"hold {speed(phase.end_ms)} km/h"
    if phase.phase == "stand":
        return f"stand {number(phase.end_s - phase.start_s, 0)} s"
    return PHASE_WORDS[phase.phase]


def advice_words(phase: Phase) -> str:
    """Return what a driver is told to do, such as 'full power to 38 km/h in 12 s' or 'coast from 45 m'."""
    text = phase_words(phase)
    start = "" if phase.start_m < AT_START_M else f" from {number(phase.start_m, 0)} m"
    if phase.phase == "stand":
        return f"{text} at {number(phase.start_m, 0)} m"
    if phase.phase in {"full_power", "part_power"}:
        return f"{PHASE_WORDS[phase.phase]}{start} to {speed(phase.end_ms)} km/h in {duration(phase)} s"
    if phase.phase == "coast" and not start:
        return "roll"
    return text + start


def duration(phase: Phase) -> str:
    """Return how long a phase takes [s], whole from ten seconds on."""
    seconds = phase.end_s - phase.start_s
    return number(seconds, 0 if seconds >= SHORT_TIME_S else 1)
