"""The stretches of an optimum, a sentence each: what is done there, and why it pays at the price of a second.

Above what it costs to make, a joule of motion is bought with full power; below what braking returns it is braked away;
between the two the train coasts: see `railjoule.core.studies.steady`, which has both values for a drive of constant
efficiency.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.energy_along import EnergyAlong, Stretch, energy_along, stretches
from railjoule.core.phases import PhaseName
from railjoule.core.phases.borders import FULL_BRAKING_SHARE
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, SHORTEST_S
from railjoule.core.studies.steady import steady_speeds
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words

LEAST_J = words.LEAST_ENERGY_KWH * J_PER_KWH


@dataclass(frozen=True)
class ToldStretch:
    """A stretch in words.

    Parameters
    ----------
    phase, where, sentence : str
        What is done, as the name of its colour; from where to where; what it is good for.
    """

    phase: PhaseName
    where: str
    sentence: str


@dataclass(frozen=True, eq=False)
class _Case:
    """What the sentences of one run tell of: prices in words, and its energy along the way."""

    run: Trajectory
    along: EnergyAlong
    second: str
    costs: str
    returns: str


def stretch_words(run: Trajectory) -> tuple[ToldStretch, ...]:
    """Return the stretches of an optimum whose drive has a constant efficiency, in order.

    A stretch on the way that is too short for an instruction of its own is left out.
    """
    price = run.price_of_time_w or 0.0
    steady = steady_speeds(run.scenario, price)
    case = _Case(
        run,
        energy_along(run),
        f"{words.price(price)} Wh a second",
        f"{words.number(steady.driving_adjoint, 2)} J",
        f"{words.number(steady.braking_adjoint, 2)} J",
    )
    parts = stretches(run)
    ends = parts[0], parts[-1]
    long = (part for part in parts if part in ends or part.phase.end_s - part.phase.start_s >= SHORTEST_S)
    return tuple(_told(part, case) for part in long)


def _told(part: Stretch, case: _Case) -> ToldStretch:
    phase = part.phase
    where = f"{words.number(phase.start_m, 0)}\u2013{words.number(phase.end_m, 0)} m"
    return ToldStretch(phase.phase, where, SENTENCES[phase.phase](part, case))


def _kwh(joules: float) -> str:
    return words.energy(joules / J_PER_KWH)


def _lasts(part: Stretch) -> str:
    return f"for {words.time(part.phase.end_s - part.phase.start_s)} s"


def _power(part: Stretch, case: _Case) -> str:
    how = "Full power" if part.phase.phase == "full_power" else "Part power"
    return (
        f"{how} to {words.speed(part.phase.end_ms, 1)} km/h, {_kwh(part.phase.energy_j)} kWh drawn: at {case.second}, "
        f"a joule of motion is worth more than the {case.costs} that it costs."
    )


def _hold(part: Stretch, case: _Case) -> str:
    done = f"Hold {words.speed(part.phase.mean_speed_ms, 1)} km/h {_lasts(part)}, {_kwh(part.phase.energy_j)} kWh drawn"
    data = case.run.run_data
    cell = int(np.searchsorted(data.position_m, part.phase.start_m, side="right")) - 1
    if part.phase.mean_speed_ms >= data.limit_ms[cell] - HOLD_TOLERANCE_MS:
        return f"{done}: faster is not allowed, and slower costs more time than it saves, at {case.second}."
    return f"{done}: faster would cost just what it saves in time, at {case.second}."


def _coast(part: Stretch, case: _Case) -> str:
    lent = _lent_j(part, case.along)
    slope = f", and slopes lend {_kwh(lent)} kWh on the way" if lent > LEAST_J else ""
    return (
        f"Coast {_lasts(part)} to {words.speed(part.phase.end_ms, 1)} km/h, nothing drawn: motion pays "
        f"{_kwh(part.resistance_j)} kWh of resistance{slope}, as a joule of it is worth less than the {case.costs} "
        f"that it costs and more than the {case.returns} that braking returns."
    )


def _brake(part: Stretch, case: _Case) -> str:
    fully = (part.phase.effort_share or 0.0) >= FULL_BRAKING_SHARE
    how = "Brake fully" if fully else "Brake along the planned curve"
    returned = -part.phase.energy_j
    back = f"{_kwh(returned)} kWh return" if returned > LEAST_J else "nothing returns"
    why = "coasting on would waste less, but take" if fully else "later is not allowed, and earlier would take"
    return (
        f"{how} from {words.speed(part.phase.start_ms, 1)} km/h: of {_kwh(-part.motion_j)} kWh of motion {back}; "
        f"{why} longer, at {case.second}."
    )


def _stand(part: Stretch, _: _Case) -> str:
    return f"Stand {_lasts(part)}."


def _lent_j(part: Stretch, along: EnergyAlong) -> float:
    """Return by how much a stretch lies lower on its way than where it starts, as energy [J]."""
    places = along.position_m[(along.position_m >= part.phase.start_m) & (along.position_m <= part.phase.end_m)]
    heights = np.interp([part.phase.start_m, *places, part.phase.end_m], along.position_m, along.height_j)
    return float(heights[0] - heights.min())


SENTENCES: Mapping[str, Callable[[Stretch, _Case], str]] = {
    "full_power": _power,
    "part_power": _power,
    "hold": _hold,
    "coast": _coast,
    "brake": _brake,
    "stand": _stand,
}
"""By what the driver does."""
