"""The stretches of an optimum, a sentence each: what the train does there, and why it pays at the price of a second.

Above its cost, a joule of kinetic energy is bought with full power; below the value of braking it is braked away;
between the two the train coasts: see `railjoule.core.studies.steady`, which has both values for a drive of constant
efficiency.
"""

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
from railjoule.dashboard.pages.learn.lessons import TEXTS

LEAST_J = words.LEAST_ENERGY_KWH * J_PER_KWH
SENTENCES = TEXTS["stretch"]


@dataclass(frozen=True)
class StretchWords:
    """A stretch in words.

    Parameters
    ----------
    phase, where, sentence : str
        The phase, as the name of its colour; its ends; what the train does and why.
    """

    phase: PhaseName
    where: str
    sentence: str


def stretch_words(run: Trajectory) -> tuple[StretchWords, ...]:
    """Return the stretches of an optimum whose drive has a constant efficiency, in order.

    A stretch on the way that is too short for an instruction of its own is left out.
    """
    price = run.price_of_time_w or 0.0
    steady, along, parts = steady_speeds(run.scenario, price), energy_along(run), stretches(run)
    prices = {
        "second": f"{words.price(price)} Wh a second",
        "costs": words.number(steady.driving_adjoint, 2),
        "returns": words.number(steady.braking_adjoint, 2),
    }
    ends = parts[0], parts[-1]
    long = (part for part in parts if part in ends or part.phase.end_s - part.phase.start_s >= SHORTEST_S)
    return tuple(_in_words(run, part, along, prices) for part in long)


def _in_words(run: Trajectory, part: Stretch, along: EnergyAlong, prices: dict[str, str]) -> StretchWords:
    phase, lent = part.phase, _lent_j(part, along)
    recovered = -phase.energy_j
    numbers = {
        "start": words.speed(phase.start_ms, 1),
        "end": words.speed(phase.end_ms, 1),
        "mean": words.speed(phase.mean_speed_ms, 1),
        "lasts": words.time(phase.end_s - phase.start_s),
        "drawn": _kwh(phase.energy_j),
        "resistance": _kwh(part.resistance_j),
        "kinetic": _kwh(-part.motion_j),
        "recovered": f"{_kwh(recovered)} kWh" if recovered > LEAST_J else "none",
        "descent": SENTENCES["descent"].format(lent=_kwh(lent)) if lent > LEAST_J else "",
    }
    where = f"{words.number(phase.start_m, 0)}\u2013{words.number(phase.end_m, 0)} m"
    return StretchWords(phase.phase, where, SENTENCES[_kind(run, part)].format(**numbers, **prices))


def _kind(run: Trajectory, part: Stretch) -> str:
    """Return which sentence a stretch has."""
    phase, data = part.phase, run.run_data
    if phase.phase == "hold":
        cell = int(np.searchsorted(data.position_m, phase.start_m, side="right")) - 1
        at_limit = phase.mean_speed_ms >= data.limit_ms[cell] - HOLD_TOLERANCE_MS
        return "hold_limit" if at_limit else "hold"
    planned = phase.phase == "brake" and (phase.effort_share or 0.0) < FULL_BRAKING_SHARE
    return "brake_curve" if planned else phase.phase


def _kwh(joules: float) -> str:
    return words.energy(joules / J_PER_KWH)


def _lent_j(part: Stretch, along: EnergyAlong) -> float:
    """Return by how much a stretch lies lower on its way than where it starts, as energy [J]."""
    places = along.position_m[(along.position_m >= part.phase.start_m) & (along.position_m <= part.phase.end_m)]
    heights = np.interp([part.phase.start_m, *places, part.phase.end_m], along.position_m, along.height_j)
    return float(heights[0] - heights.min())
