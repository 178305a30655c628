"""What a sweep tells of a run: columns of its table, by name."""

from collections.abc import Callable, Sequence
from typing import Protocol

from railjoule.core.energy import Energy
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import shorten, suggestion
from railjoule.core.units import J_PER_KWH


class Run(Protocol):
    """What a column may ask of a run: a trajectory, or the few numbers that are left of one."""

    @property
    def energy(self) -> Energy:
        """The account of the whole run."""

    @property
    def energy_kwh(self) -> float:
        """Net energy at the line, auxiliaries included [kWh]."""

    @property
    def lower_bound_kwh(self) -> float | None:
        """Energy that no run undercuts [kWh], if known."""

    @property
    def travel_time_s(self) -> float:
        """Time of the whole run, dwells included [s]."""

    @property
    def price_of_time_w(self) -> float | None:
        """By how much the optimum falls if the timetable is a second longer [J/s], if known."""

    @property
    def max_speed_kmh(self) -> float:
        """Greatest speed [km/h]."""


Column = Callable[[Run], float | None]


def _loss(kind: str) -> Column:
    # a train whose drive knows no such loss has none of it
    return lambda run: run.energy.losses_j.get(kind, 0.0) / J_PER_KWH


def _part(name: str) -> Column:
    return lambda run: getattr(run.energy, name) / J_PER_KWH


DEFAULT_COLUMNS = ("energy_kwh", "lower_bound_kwh", "travel_time_s", "price_of_time_w")
COLUMNS: dict[str, Column] = {
    "energy_kwh": lambda run: run.energy_kwh,
    "lower_bound_kwh": lambda run: run.lower_bound_kwh,
    "travel_time_s": lambda run: run.travel_time_s,
    "price_of_time_w": lambda run: run.price_of_time_w,
    "max_speed_kmh": lambda run: run.max_speed_kmh,
    "traction_energy_kwh": _part("traction_j"),
    "recuperated_kwh": _part("recuperated_j"),
    "auxiliary_kwh": _part("auxiliary_j"),
    "running_resistance_kwh": _part("running_resistance_j"),
    "curve_resistance_kwh": _part("curve_resistance_j"),
    "kinetic_kwh": _part("kinetic_j"),
    "potential_kwh": _part("potential_j"),
    "losses_kwh": lambda run: sum(run.energy.losses_j.values()) / J_PER_KWH,
    "brake_resistors_kwh": _loss("brake_resistors"),
    "friction_brakes_kwh": _loss("friction_brakes"),
}
"""All columns there are; `losses_kwh` are those of drive, resistors and friction brakes together."""


def require_columns(names: Sequence[str]) -> None:
    """Raise ScenarioError if there is a column that no sweep has, or one is named twice."""
    for name in names:
        if name not in COLUMNS:
            raise ScenarioError(f"there is no column {shorten(name)}: {suggestion(name, COLUMNS)}.".replace("?.", "?"))
        if list(names).count(name) > 1:
            raise ScenarioError(f"the column {name} is named twice.")
