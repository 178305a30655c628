"""The speeds at which the optimum holds, coasts and brakes on level track, from the price of a second.

On level track a train of constant efficiency has a first integral. With p, the adjoint variable of the kinetic energy,
which is the worth of a joule of motion in joules of the supply, e and k the efficiencies of driving, and of braking
with recuperation, R(v) the running resistance and m the price of a second, p f - P / v - p R - m / v is the same all
along the run. So each speed determines p: full power where p > 1 / e, holding where p = 1 / e, coasting between k and
1 / e, braking with recuperation at k, braking beyond that below it. The speed held, V, balances V^2 R'(V) = e m, and
braking begins at U where k R(U) + m / U = R(V) / e + m / V. A run that is too short for V coasts from its highest
speed, which stands for V in that balance.

References: Howlett, Pudney: Energy-Efficient Train Control, 1995, chapters 3 and 5; with recuperation as in Albrecht,
Howlett, Pudney, Vu, Zhou: The key principles of optimal train control, Transportation Research B 94, 2016.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.physics.adhesion import adhesive_weight
from railjoule.core.physics.resistance import (
    resistance_coefficients,
    resistance_slope,
    running_resistance,
    starting_resistance,
    starting_terms,
)
from railjoule.core.physics.vehicle_limit import vehicle_limit_n
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import MS_PER_KMH

# price over speed grows without bound towards rest, where the curves are drawn no further
SLOWEST_MS = 0.1
POINTS = 120
PhaseOfSpeed = Literal["full_power", "coast", "brake"]


@dataclass(frozen=True, eq=False)
class SteadySpeeds:
    """The speeds of a run on level track for a price of a second.

    Parameters
    ----------
    price_of_time_w : float
        The multiplier of the timetable [J/s].
    hold_ms : float
        The speed that the optimum holds, if its way is long enough, the vehicle's limit included [m/s].
    highest_ms : float
        The speed from which it coasts: that one, or the highest of a run too short for it [m/s].
    brake_ms : float
        The speed to which it coasts before it brakes [m/s].
    driving_adjoint, braking_adjoint : float
        The adjoint while the speed is held by power and by the recuperating brake: joules at the line for one joule at
        the wheels, taken in driving, given back in braking.
    """

    price_of_time_w: float
    hold_ms: float
    highest_ms: float
    brake_ms: float
    driving_adjoint: float
    braking_adjoint: float


@dataclass(frozen=True, eq=False)
class PhaseCurve:
    """A part of a run over its speed; arrays of shape (n,), in the order of driving.

    Parameters
    ----------
    phase : str
    speed_ms : array
        Speeds [m/s].
    adjoint : array
        The adjoint variable there: what a joule of motion is worth, in joules at the line.
    """

    phase: PhaseOfSpeed
    speed_ms: FloatArray
    adjoint: FloatArray


def steady_speeds(scenario: Scenario, price_of_time_w: float, highest_ms: float | None = None) -> SteadySpeeds:
    """Return at which speeds the optimum holds, coasts and brakes on level track.

    Parameters
    ----------
    scenario : Scenario
        Its vehicle and drive count.
    price_of_time_w : float
        The price of a second [J/s], above 0.
    highest_ms : float, optional
        The highest speed of a run that may be too short to reach the speed that is held [m/s].

    Raises
    ------
    StrategyRefusedError
        If the drive has another loss model than a constant efficiency.
    """
    drive = scenario.vehicle.drive
    if not isinstance(drive, ConstantEfficiency):
        raise StrategyRefusedError("needs a drive of constant efficiency.")
    driving = 1.0 / drive.traction_efficiency
    # k of the text: what of a joule at the wheels comes back to the line
    braking = drive.recuperation_factor * (drive.braking_efficiency or drive.traction_efficiency)
    _, linear, quadratic = _coefficients(scenario)
    top = scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH

    def hold_excess_w(speed: float) -> float:
        return driving * speed**2 * resistance_slope(linear, quadratic, speed) - price_of_time_w

    # V^2 R'(V) rises from 0 with V, so there is one root, or none below the top speed, which is then held
    hold = float(scipy.optimize.brentq(hold_excess_w, 0.0, top)) if hold_excess_w(top) > 0 else top
    highest = hold if highest_ms is None else min(highest_ms, hold)
    # the constant of the first integral, taken where coasting begins: f = 0, P = 0 and p = 1 / e there
    level = float(driving * _resistance_n(scenario, highest)) + price_of_time_w / highest

    def brake_excess(speed: float) -> float:
        return float(braking * _resistance_n(scenario, speed)) + price_of_time_w / speed - level

    # at the highest speed this is negative, as braking_adjoint < driving_adjoint; towards rest price / speed makes it
    # positive, unless the price is next to nothing: then the train coasts to walking pace
    slow = min(SLOWEST_MS, 0.5 * highest)
    brake = float(scipy.optimize.brentq(brake_excess, slow, highest)) if brake_excess(slow) > 0 else slow
    return SteadySpeeds(price_of_time_w, hold, highest, brake, driving, braking)


def phase_plane(scenario: Scenario, steady: SteadySpeeds) -> tuple[PhaseCurve, ...]:
    """Return a run on level track as its adjoint variable over speed: full power, coasting, braking.

    Parameters
    ----------
    scenario : Scenario
        Whose vehicle it is.
    steady : SteadySpeeds
        Of `steady_speeds`.
    """
    vehicle, price = scenario.vehicle, steady.price_of_time_w
    level = steady.driving_adjoint * _resistance_n(scenario, steady.highest_ms) + price / steady.highest_ms
    up = np.linspace(SLOWEST_MS, steady.highest_ms, POINTS)
    driven_n = adhesive_weight(scenario, scenario.line.rail_condition).driven_n
    effort = vehicle_limit_n(vehicle, up, driven_n=driven_n)
    # p from the first integral, p (f - R) = P / v + m / v - level, with P = f v / e
    full = (steady.driving_adjoint * effort + price / up - level) / (effort - _resistance_n(scenario, up))
    down = np.linspace(steady.highest_ms, steady.brake_ms, POINTS)
    coast = (level - price / down) / _resistance_n(scenario, down)
    last = np.linspace(steady.brake_ms, SLOWEST_MS, POINTS)
    brakes = vehicle_limit_n(vehicle, last, braking=True, driven_n=driven_n)
    # the same with f = -B, of which the line gets k B v
    brake = (level + steady.braking_adjoint * brakes - price / last) / (brakes + _resistance_n(scenario, last))
    return PhaseCurve("full_power", up, full), PhaseCurve("coast", down, coast), PhaseCurve("brake", last, brake)


def _coefficients(scenario: Scenario) -> tuple[float, float, float]:
    return resistance_coefficients(scenario.vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)


def _resistance_n(scenario: Scenario, speed_ms: FloatArray | float) -> FloatArray:
    speed = np.asarray(speed_ms, dtype=float)
    starting = starting_resistance(*starting_terms(scenario.vehicle), speed)
    return np.asarray(running_resistance(*_coefficients(scenario), speed, np.square(speed)) + starting)
