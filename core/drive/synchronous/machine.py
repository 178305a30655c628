"""Steady states of the machine in the frame of its magnets: least current, and less flux where the voltage asks for it.

Flux psi_d = psi_m + L_d i_d, psi_q = L_q i_q; torque T = 3/2 p (psi_d i_q - psi_q i_d) = 3/2 p i_q (psi_m - (L_q - L_d)
i_d); voltage u_d = R i_d - w psi_q, u_q = R i_q + w psi_d; amplitudes per phase. With L_q > L_d a current against the
magnets, i_d < 0, adds torque and takes flux away. Along a torque the current is least where
i_d + i_q^2 (L_q - L_d) / (psi_m - (L_q - L_d) i_d) = 0, and left of there the voltage falls before it rises.

Source: Morimoto, Sanada, Takeda: Wide-speed operation of interior permanent magnet synchronous motors, IEEE
Transactions on Industry Applications 30, 1994.
"""

import math
from typing import NamedTuple

from railjoule.core.compiled import njit
from railjoule.core.golden_section import Bracket, inner_points, narrowed, next_point

# 2^-40 = 1e-12 of the bracket
HALVINGS = 40
# 0.618^28 = 1e-6 of the bracket: at its least value the voltage is flat, so within 1e-12
NARROWINGS = 28


class Machine(NamedTuple):
    """The numbers of one machine that its steady state needs.

    Parameters
    ----------
    pole_pairs : float
        p.
    magnet_flux_vs : float
        psi_m, amplitude of a phase's flux linkage [V s].
    direct_inductance_h, quadrature_inductance_h : float
        L_d and L_q [H].
    stator_resistance_ohm : float
        R [ohm].
    max_current_a, max_phase_voltage_v : float
        Limits of the amplitudes per phase [A, V].
    """

    pole_pairs: float
    magnet_flux_vs: float
    direct_inductance_h: float
    quadrature_inductance_h: float
    stator_resistance_ohm: float
    max_current_a: float
    max_phase_voltage_v: float


@njit(cache=True)
def _across(machine: Machine, torque: float, along: float) -> float:
    """Return the current across the magnets that gives a torque [N m] with a current along them [A]."""
    saliency = machine.quadrature_inductance_h - machine.direct_inductance_h
    return torque / (1.5 * machine.pole_pairs * (machine.magnet_flux_vs - saliency * along))


@njit(cache=True)
def phase_voltages(machine: Machine, along: float, across: float, stator_rads: float) -> tuple[float, float]:
    """Return the voltages along and across the magnets [V] for currents [A] at a frequency of the stator [rad/s]."""
    # steady state: no derivatives, so each flux turns into a voltage on the other axis, by the frequency
    direct = machine.stator_resistance_ohm * along - stator_rads * machine.quadrature_inductance_h * across
    flux = machine.magnet_flux_vs + machine.direct_inductance_h * along
    return direct, machine.stator_resistance_ohm * across + stator_rads * flux


@njit(cache=True)
def _voltage2(machine: Machine, torque: float, stator_rads: float, along: float) -> float:
    """Return the square of the phase voltage's amplitude [V2] for a torque and a current along the magnets [A]."""
    direct, quadrature = phase_voltages(machine, along, _across(machine, torque, along), stator_rads)
    return direct * direct + quadrature * quadrature


@njit(cache=True)
def min_current(machine: Machine, torque: float) -> float:
    """Return the current along the magnets [A] with which a torque [N m] needs the least current."""
    saliency = machine.quadrature_inductance_h - machine.direct_inductance_h
    low, high = -machine.max_current_a, 0.0
    for _ in range(HALVINGS):
        along = 0.5 * (low + high)
        across = _across(machine, torque, along)
        # Half of the derivative of i_d^2 + i_q^2 along a torque, where i_q goes as 1 / (psi_m - (L_q - L_d) i_d) and so
        # i_q' = i_q (L_q - L_d) / (psi_m - (L_q - L_d) i_d). It rises with i_d: negative left of the least current.
        if along + across * across * saliency / (machine.magnet_flux_vs - saliency * along) > 0.0:
            high = along
        else:
            low = along
    return 0.5 * (low + high)


@njit(cache=True)
def _min_voltage(machine: Machine, torque: float, stator_rads: float, below: float) -> float:
    """Return the current along the magnets [A] below another one at which a torque needs the least voltage."""
    lowest = -machine.max_current_a
    left, right = inner_points(lowest, below)
    at_left = _voltage2(machine, torque, stator_rads, left)
    at_right = _voltage2(machine, torque, stator_rads, right)
    bracket = Bracket(lowest, left, right, below, at_left, at_right)
    for _ in range(NARROWINGS):
        bracket = narrowed(bracket, _voltage2(machine, torque, stator_rads, next_point(bracket)))
    return 0.5 * (bracket.left + bracket.right)


@njit(cache=True)
def currents(machine: Machine, torque: float, stator_rads: float) -> tuple[float, float, bool]:
    """Return the currents along and across the magnets [A] for a torque, and whether current and voltage allow them.

    Parameters
    ----------
    machine : Machine
    torque : float
        Electromagnetic, negative where the machine generates [N m].
    stator_rads : float
        Electrical angular frequency [rad/s].
    """
    along = min_current(machine, torque)
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    feasible = True
    if _voltage2(machine, torque, stator_rads, along) > voltage2:
        # left of the least current the voltage falls and rises again: find its least, then the root between the two
        low, high = _min_voltage(machine, torque, stator_rads, along), along
        feasible = _voltage2(machine, torque, stator_rads, low) <= voltage2
        if feasible:
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if _voltage2(machine, torque, stator_rads, middle) > voltage2:
                    high = middle
                else:
                    low = middle
        along = low
    across = _across(machine, torque, along)
    return along, across, feasible and math.hypot(along, across) <= machine.max_current_a


@njit(cache=True)
def max_torque(machine: Machine, sign: float, stator_rads: float, max_nm: float) -> float:
    """Return the greatest electromagnetic torque [N m], without sign, up to `max_nm`; `sign` is -1 generating."""
    low, high = 0.0, max_nm
    # bisection: a machine that carries a torque is taken to carry all smaller ones
    if currents(machine, sign * high, stator_rads)[2]:
        return high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if currents(machine, sign * middle, stator_rads)[2]:
            low = middle
        else:
            high = middle
    return low
