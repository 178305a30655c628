"""Two scenarios side by side, in words: the measures of their runs with the differences, and the scenarios' own."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from railjoule.core import Scenario, Trajectory
from railjoule.core.measures import measure
from railjoule.core.units import KG_PER_T
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.differences import difference_words

HEAD = ("Quantity", "First", "Second", "Difference", "%")
SAME_LENGTH_M = 0.5
"""Lines whose lengths differ by no more read as equally long."""
Measures = Mapping[str, float | None]


class Kind(NamedTuple):
    """Quantity and unit of a measure, and the functions that write its values and their differences."""

    words: str
    value: Callable[[float], str]
    difference: Callable[[float], str]


def _digits(count: int, scale: float = 1.0) -> tuple[Callable[[float], str], Callable[[float], str]]:
    return lambda value: words.number(value / scale, count), lambda value: words.signed(value / scale, count)


ENERGY = words.energy, words.energy_difference
KINDS: Mapping[str, Kind] = {
    "energy_kwh": Kind("Energy, kWh", *ENERGY),
    "energy_per_km_kwh": Kind("Energy per km, kWh/km", *ENERGY),
    "energy_per_tonne_km_wh": Kind("Energy per tonne and km, Wh", *_digits(1)),
    "recuperated_kwh": Kind("Recuperated, kWh", *ENERGY),
    "travel_time_s": Kind("Travel time, s", words.time, words.delay),
    "mean_speed_kmh": Kind("Mean speed, km/h", *_digits(1)),
    "max_speed_kmh": Kind("Highest speed, km/h", *_digits(1)),
    "max_supply_power_kw": Kind("Largest power, kW", *_digits(0)),
    "max_supply_current_a": Kind("Largest current, A", *_digits(0)),
    "distance_m": Kind("Length, m", *_digits(0)),
    "total_mass_kg": Kind("Mass, t", *_digits(1, KG_PER_T)),
    "lower_bound_kwh": Kind("Lower bound, kWh", *ENERGY),
}
"""The measures of `railjoule.core.measures` in the order of the table; power and current are those of the supply."""


def pair_rows(first: Trajectory, second: Trajectory) -> list[tuple[str, ...]]:
    """Return the rows of the table with the head `HEAD`; a quantity that neither run has is left out."""
    one, other = measure(first), measure(second)
    rows = [
        (kind.words, *_cells(name, one[name], other[name]))
        for name, kind in KINDS.items()
        if not one[name] is other[name] is None
    ]
    proofs = (comparisons.cell(comparisons.above_own_bound(run)) for run in (first, second))
    proven = ("yes" if run.is_proven else "no" for run in (first, second))
    return [*rows, ("Above the bound, %", *proofs, "", ""), ("Proven optimal", *proven, "", "")]


def _cells(name: str, one: float | None, other: float | None) -> tuple[str, str, str, str]:
    """Return both values of a measure, their difference, and the same in per cent of the first value."""
    kind = KINDS[name]
    first, second = (words.UNKNOWN if value is None else kind.value(value) for value in (one, other))
    if one is None or other is None:
        return first, second, words.UNKNOWN, words.UNKNOWN
    share = words.share_difference(other / one - 1) if one > 0 else words.UNKNOWN
    # of energies, which can be next to nothing or negative, a share may mean nothing
    percent = comparisons.above(other, one).cell if name.endswith("_kwh") else share
    return first, second, kind.difference(other - one), percent


def differences(first: Trajectory, second: Trajectory) -> dict[str, float]:
    """Return the measures of the second run less those of the first, where both have one."""
    one, other = measure(first), measure(second)
    pairs = ((name, before, other[name]) for name, before in one.items())
    return {name: after - before for name, before, after in pairs if before is not None and after is not None}


def scenarios_differ(first: Scenario, second: Scenario) -> str:
    """Return in one sentence by what the second scenario differs from the first."""
    sentences = "; ".join(difference_words(second, first))
    if sentences:
        return f"The second scenario has {sentences}."
    return "Both scenarios are the same." if first.strategy == second.strategy else "Only their strategies differ."


def pair_names(first: Trajectory, second: Trajectory) -> tuple[str, str]:
    """Return short names of two scenarios: their titles, or where these are the same the trains or the times."""
    scenarios = first.scenario, second.scenario
    for one, other in (
        [words.title(scenario.title) for scenario in scenarios],
        [scenario.vehicle.name for scenario in scenarios],
        [f"{words.time(scenario.travel_time_s)} s" for scenario in scenarios],
    ):
        if one != other and one and other:
            return one, other
    return words.title(first.scenario.title), words.title(second.scenario.title)


def lengths_differ(first: Trajectory, second: Trajectory) -> str:
    """Return a sentence on lines of different lengths; empty where they have the same."""
    if abs(first.distance_m - second.distance_m) <= SAME_LENGTH_M:
        return ""
    lengths = (words.number(run.distance_m, 0) for run in (first, second))
    return f"The lines are {' and '.join(lengths)} m long; both are drawn from their start."
