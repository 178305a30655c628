"""Numbers and phases as people read them: narrow spaces for thousands, a true minus, a unit's usual digits.

Each quantity has one function here, so that it reads alike on every page, in charts, in reports and, made plain, in a
terminal. Comparisons of runs are in `railjoule.dashboard.look.comparisons`.
"""

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from typing import TYPE_CHECKING, ParamSpec

from railjoule.core import RailjouleError, ScenarioError, TimetableError
from railjoule.core.advice import Instruction
from railjoule.core.energy import energy_decimals
from railjoule.core.phases import PhaseName
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.strategy import STRATEGIES
from railjoule.core.trajectory import BY_HAND, MEASURED
from railjoule.core.units import J_PER_WH, MS_PER_KMH

# only for mypy, as simulations are slow to import, and every command imports this module
if TYPE_CHECKING:
    from railjoule.core.simulation.actual_run import CauseName

THIN_SPACE = "\u202f"
MINUS = "\u2212"
PER_MILLE = "\u2030"
UNKNOWN = "\u2013"
PLAIN_SIGNS = str.maketrans({THIN_SPACE: ",", MINUS: "-", UNKNOWN: "-"})
"""Their form in a terminal."""

STRATEGY_WORDS: dict[str, str] = {name: strategy.label for name, strategy in STRATEGIES.items()}
ADVISED = "advised"
NOT_STRATEGIES = {MEASURED: "Measured", ADVISED: "Simple advice", BY_HAND: "Driven by hand"}
"""Names of runs without a strategy."""
REACTION_WORDS: dict[Reaction, str] = {
    "driver": "Driver",
    "computer": "Replanned",
    "known": "With advance notice",
}
"""Reactions to an event on the way."""
PHASE_WORDS: dict[PhaseName, str] = {
    "full_power": "full power",
    "part_power": "part power",
    "hold": "hold",
    "coast": "coast",
    "brake": "brake",
    "stand": "stand",
}
CAUSE_WORDS: "dict[CauseName, str]" = {
    "load": "Other load",
    "position": "Position error",
    "conditions": "Resistance, voltage, rails",
    "stops": "Unplanned stops",
    "events": "Limits, changes",
}
LOSS_WORDS = {
    "running_resistance": "Running resistance",
    "curve_resistance": "Curves",
    "drive": "Powertrain losses",
    "copper": "Copper loss",
    "magnetising": "Magnetising loss",
    "iron": "Iron loss",
    "mechanical": "Friction in the motors",
    "harmonics": "Harmonics of the inverter",
    "inverter": "Inverter",
    "motors_and_inverters": "Motors and inverters",
    "gear": "Gears",
    "standstill_brake": "Standstill brake",
    "brake_resistors": "Brake resistors",
    "friction_brakes": "Friction brakes",
    "unexplained": "Measured, not explained by the model",
}
"""Names of energy losses, by the balance's keys."""
PART_WORDS = {
    "shaft": "Shaft",
    "stator_copper": "Stator copper, torque current",
    "rotor_copper": "Rotor copper",
    "magnetising": "Stator copper, magnetising",
    "iron": "Iron",
    "stored": "Stored in the magnetic fields",
}
"""Energy breakdown of machines in closed loop."""
# half of the last decimal that small energies have
LEAST_ENERGY_KWH = 5e-4
"""An energy below this reads as zero."""
SMALL_PRICE_WH_PER_S = 100.0
GRADUAL_FROM = 3
"""So many pieces of one action make a gradual one."""
# places are shown in whole metres
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


QUANTITY = re.compile(r"(?<![\w.,:\u202f-])(\d{4,})(?=(?:\.\d+)? (?:k?m|s|k?Wh?|V|A|k?N|t|kg|m/s2|km/h)\b)")
"""The whole part of a quantity of four digits or more: no year, and none of a name."""


def number(value: float, digits: int = 1) -> str:
    """Return a number with `digits` decimals, narrow spaces between thousands and a true minus; a dash for NaN."""
    if not math.isfinite(value):
        return UNKNOWN
    text = f"{abs(value):,.{digits}f}".replace(",", THIN_SPACE)
    # what rounds to zero has no sign
    negative = value < 0 and any(character in "123456789" for character in text)
    return (MINUS if negative else "") + text


def grouped(text: str) -> str:
    """Return a sentence of the core with narrow spaces between the thousands of its quantities."""
    return QUANTITY.sub(lambda found: f"{int(found[1]):,}".replace(",", THIN_SPACE), text)


def decimals(value: float | None) -> int:
    """Return how many decimals a printed number has; 2 where none is printed."""
    if value is None:
        return 2
    # the shortest text that gives the number again: as it was printed
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
    # the borders lie where a rounded percentage reads 1 or 100: 0.996 reads 1.0, not 1.00
    return 2 if abs(percent) < 0.995 else 1 if abs(percent) < 99.95 else 0


def setting(factor: float) -> str:
    """Return a share that was set, such as a load, in percent: whole unless it was set finer."""
    # within half a tenth of a whole percent one decimal would read 0
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
    """Return the name of a run's strategy, or of the run if it has none."""
    return NOT_STRATEGIES.get(name) or STRATEGY_WORDS[name]


def title(given: str) -> str:
    """Return the name of a scenario."""
    return given or "Untitled scenario"


def vehicle_load(vehicle: Vehicle) -> str:
    """Return the load of a vehicle in words: a share of the capacity or a mass."""
    return load(vehicle.load_factor) if vehicle.load_t is None else f"load {setting(vehicle.load_t / 100)} t"


def subtitle(distance_m: float, vehicle: Vehicle) -> str:
    """Return the line below a scenario's title: length of the track, vehicle and load."""
    return f"{distance(distance_m)} km, {vehicle.name}, {vehicle_load(vehicle)}"


def about(strategy: str, sentence: str) -> str:
    """Return a sentence of a strategy that names it."""
    return sentence if sentence.startswith(strategy) else f"{strategy}: {sentence}"


def notes_by_run(notes: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the notes of runs, given by name, each with its run; a note of all runs comes once, without a name."""
    lines: list[str] = []
    for name, sentences in notes.items():
        for sentence in sentences:
            is_common = len(notes) > 1 and all(sentence in others for others in notes.values())
            lines.append(sentence if is_common else about(name, sentence))
    return list(dict.fromkeys(lines))


def notice(position_m: float, time_s: float, event: str) -> str:
    """Return place and time at which a train learns of an event."""
    return f"At {number(position_m, 0)} m, after {time(time_s)} s: {event}."


def speed(ms: float, digits: int = 0) -> str:
    """Return a speed [m/s] in km/h."""
    return number(ms / MS_PER_KMH, digits)


def tenths(value: float, number: Callable[[float, int], str] = number) -> str:
    """Return a number as the advice has it: in tenths, whole where it is."""
    return number(value, 0 if value == round(value) else 1)


def advice_words(
    instruction: Instruction, number: Callable[[float, int], str] = number, named: Collection[float] = ()
) -> str:
    """Return an instruction in words, such as 'full power to 36.9 km/h' or 'brake from 593 m to 50 km/h at 600 m'.

    Parameters
    ----------
    instruction : Instruction
        One line of the advice, whose numbers are printed as they are.
    number : callable
        Writes a number with its decimals.
    named : collection of float
        Places that are named beside it, and not repeated [m].
    """

    def place(word: str, place_m: float | None) -> str:
        return "" if place_m is None or place_m in named else f" {word} {number(place_m, 0)} m"

    action = "brake fully" if instruction.fully else PHASE_WORDS[instruction.action]
    if instruction.action == "stand":
        return f"{action} {tenths(instruction.stand_s or 0.0, number)} s{place('at', instruction.from_m)}"
    start = place("from", instruction.from_m) if instruction.from_m >= AT_START_M else ""
    if instruction.action == "hold":
        return f"{action} {tenths(instruction.to_kmh or 0.0, number)} km/h{start}{_turns_words(instruction, number)}"
    if instruction.to_kmh is None:
        return f"{action}{start}" if start or instruction.action != "coast" else "roll"
    aim = f"{tenths(instruction.to_kmh, number)} km/h" if instruction.to_kmh > 0 else "a stop"
    return f"{action}{start} to {aim}{place('at', instruction.at_m)}"


def instruction_groups(advice: Sequence[Instruction]) -> list[tuple[int, ...]]:
    """Return the indices of instructions that a driver carries out as one.

    If an optimum eases power or brake continuously, its instructions are the pieces of one curve: from three of one
    action in succession on, they are one group.
    """
    chains: list[tuple[int, ...]] = []
    for k, instruction in enumerate(advice):
        if k and _continues(advice[k - 1], instruction):
            chains[-1] += (k,)
        else:
            chains.append((k,))
    return [group for one in chains for group in ([one] if len(one) >= GRADUAL_FROM else [(k,) for k in one])]


def _continues(before: Instruction, instruction: Instruction) -> bool:
    return before.action == instruction.action and before.at_m == instruction.from_m


def advice_in_words(
    advice: Sequence[Instruction], number: Callable[[float, int], str] = number, named: Collection[float] = ()
) -> Iterator[str]:
    """Yield one text per group of `instruction_groups`; a place where the same action has ended is not repeated.

    Arguments as `advice_words`.
    """
    for group in instruction_groups(advice):
        first, last = advice[group[0]], advice[group[-1]]
        before = advice[group[0] - 1] if group[0] else None
        eased_from_kmh = before.to_kmh if before is not None and last.action == "part_power" else None
        if eased_from_kmh is not None and last.to_kmh is not None and last.to_kmh < eased_from_kmh:
            speeds = f"{tenths(eased_from_kmh, number)} to {tenths(last.to_kmh, number)} km/h"
            yield f"ease off from {speeds} between {number(first.from_m, 0)} m and {number(last.at_m or 0.0, 0)} m"
            continue
        places = (*named, first.from_m) if before is not None and _continues(before, first) else named
        if len(group) == 1:
            yield advice_words(first, number, places)
            continue
        whole = advice_words(replace(last, from_m=first.from_m, fully=False), number, places)
        action = PHASE_WORDS[last.action]
        yield whole.replace(action, f"{action} gradually", 1)


def _turns_words(instruction: Instruction, number: Callable[[float, int], str]) -> str:
    """Return how a speed is held by turns; nothing where it just is."""
    if instruction.between_kmh is None:
        return ""
    low, high = (tenths(speed, number) for speed in instruction.between_kmh)
    share = instruction.power_share or 1.0
    power = "full power" if share == 1 else f"{100 * share:.0f} % power"
    return f" by turns: {power} to {high} km/h, coast to {low} km/h"


def slug(text: str) -> str:
    """Return the letters and digits of a text for the name of a file, in lower case, joined by hyphens."""
    # cut before it is stripped, as the cut may end with a hyphen
    return "-".join(re.findall(r"[a-z0-9]+", text.lower()))[:60].strip("-")


def failure_words(failure: RailjouleError) -> tuple[str, str]:
    """Return an error as what is wrong and why."""
    if isinstance(failure, TimetableError):
        asked, shortest = number(failure.travel_time_s), number(failure.shortest_time_s)
        return f"{asked} s is too short.", f"The shortest possible run takes {shortest} s."
    if isinstance(failure, ScenarioError):
        return "This input cannot be read.", str(failure)
    return "This run is not possible.", str(failure)
