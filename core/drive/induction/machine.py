"""One induction machine in the frame of its rotor flux, in steady state: the one set of formulas for it.

x is the axis of the rotor flux. All currents and voltages are amplitudes per phase. With sigma = 1 - M^2 / (L_S L_W):

    slip           wr = (R_W / L_W) Iy / Ix                     w1 = w + wr
    torque         T  = (3/2) p (M^2 / L_W) Ix Iy
    voltages       Ux = R_S Ix - w1 sigma L_S Iy                Uy = R_S Iy + w1 L_S Ix
    iron loss      [Ph |w1| / w1N + Pe (w1 / w1N)^2] (Ix / Imu)^2
    input power    (3/2) (Ux Ix + Uy Iy) + iron loss = stator copper + rotor copper + iron loss + T w / p

Source: Rawicki, "New software for energy saving control of a tram vehicle", (1)-(13) and (25)-(32).
"""

import math
from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.geared import LOSSES


class Machine(NamedTuple):
    """The parameters of one machine.

    Parameters
    ----------
    stator_resistance_ohm, rotor_resistance_ohm : float
        R_S, R_W [ohm].
    stator_inductance_h, rotor_inductance_h, mutual_inductance_h : float
        L_S, L_W, M [H].
    magnetising_current_a : float
        Imu: the largest Ix, that of the rated flux [A].
    hysteresis_loss_ws, eddy_loss_ws2 : float
        Iron losses at rated flux over w1 [W s] and over its square [W s2].
    mechanical_loss_torque_nm : float
        T_m, torque of friction and ventilation [N m].
    max_phase_voltage_v : float
        U_m [V].
    pole_pairs : float
        p.
    """

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    stator_inductance_h: float
    rotor_inductance_h: float
    mutual_inductance_h: float
    magnetising_current_a: float
    hysteresis_loss_ws: float
    eddy_loss_ws2: float
    mechanical_loss_torque_nm: float
    max_phase_voltage_v: float
    pole_pairs: float


class SteadyState(NamedTuple):
    """The steady state of a machine with two currents at a speed; signed, generating with a negative torque.

    Parameters
    ----------
    slip_rads, stator_rads : float
        Electrical angular frequencies of slip and stator, wr and w1 [rad/s].
    torque_nm : float
        Electromagnetic torque [N m].
    voltage_x_v, voltage_y_v : float
        Stator voltages [V].
    stator_copper_w, rotor_copper_w, iron_w : float
        Losses [W].
    input_power_w : float
        Power at the terminals, iron loss included [W].
    """

    slip_rads: float
    stator_rads: float
    torque_nm: float
    voltage_x_v: float
    voltage_y_v: float
    stator_copper_w: float
    rotor_copper_w: float
    iron_w: float
    input_power_w: float


@njit(cache=True)
def make_machine(parameters: FloatArray) -> Machine:
    """Return the machine in the parameters of a drive: they follow those of all geared drives."""
    m = parameters[LOSSES:]
    return Machine(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10])


@njit(cache=True)
def leakage_share(machine: Machine) -> float:
    """Return sigma = 1 - M^2 / (L_S L_W)."""
    mutual = machine.mutual_inductance_h
    return 1.0 - mutual * mutual / (machine.stator_inductance_h * machine.rotor_inductance_h)


@njit(cache=True)
def torque_constant(machine: Machine) -> float:
    """Return the torque over the product of both currents, (3/2) p M^2 / L_W [N m/A2]."""
    mutual = machine.mutual_inductance_h
    return 1.5 * machine.pole_pairs * mutual * mutual / machine.rotor_inductance_h


@njit(cache=True)
def slip_rate(machine: Machine) -> float:
    """Return the slip over the ratio of the currents Iy / Ix, R_W / L_W [rad/s]."""
    return machine.rotor_resistance_ohm / machine.rotor_inductance_h


@njit(cache=True)
def steady_state(machine: Machine, flux_current_a: float, torque_current_a: float, rotor_rads: float) -> SteadyState:
    """Return the steady state of a machine with its two currents.

    Parameters
    ----------
    machine : Machine
        Its numbers.
    flux_current_a, torque_current_a : float
        Ix, above zero unless both are zero, and Iy, negative where it generates [A].
    rotor_rads : float
        Electrical angular frequency of the rotor, p times its angular speed [rad/s].
    """
    i_x, i_y = flux_current_a, torque_current_a
    # without flux there is no torque either: machines that are off have no slip
    slip = slip_rate(machine) * i_y / i_x if i_x > 0.0 else 0.0
    frequency = rotor_rads + slip
    torque = torque_constant(machine) * i_x * i_y
    resistance, inductance = machine.stator_resistance_ohm, machine.stator_inductance_h
    # steady state: no derivatives, so only the stator's frequency turns fluxes into voltages
    voltage_x = resistance * i_x - frequency * leakage_share(machine) * inductance * i_y
    voltage_y = resistance * i_y + frequency * inductance * i_x
    # hysteresis and eddy-current losses, (10)-(11), grow with the square of the flux, that is of Ix
    flux = i_x / machine.magnetising_current_a
    by_frequency = machine.hysteresis_loss_ws + machine.eddy_loss_ws2 * abs(frequency)
    iron = by_frequency * abs(frequency) * flux * flux
    # of amplitudes, three phases have 3/2 of the product
    return SteadyState(
        slip,
        frequency,
        torque,
        voltage_x,
        voltage_y,
        1.5 * resistance * (i_x * i_x + i_y * i_y),
        # of the power that crosses the air gap, T w1 / p, the slip's part heats the rotor
        torque * slip / machine.pole_pairs,
        iron,
        1.5 * (voltage_x * i_x + voltage_y * i_y) + iron,
    )


@njit(cache=True)
def phase_voltage_v(state: SteadyState) -> float:
    """Return the amplitude of the stator voltage [V], (14)."""
    return math.hypot(state.voltage_x_v, state.voltage_y_v)
