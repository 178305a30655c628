"""Numbers and phases as people read them: narrow spaces for thousands, a true minus, a unit's usual digits."""

from railjoule.core.phases import Phase, PhaseName
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
SHORT_TIME_S = 10.0
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


def load(factor: float) -> str:
    """Return how full a vehicle is, such as 'load 50 %' or 'crush load, 120 % of capacity'."""
    percent = number(100 * factor).removesuffix(".0")
    return f"crush load, {percent} % of capacity" if factor > 1 else f"load {percent} %"


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
