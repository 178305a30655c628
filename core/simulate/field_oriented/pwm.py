"""A moment of a run with an inverter that switches: two levels, space vectors, sampled once a period of the carrier.

The machine is that of the inverse-gamma circuit in the frame of the stator. Speed, flux and the wanted voltage are
those of the run at that moment; the voltage turns with the flux. Both halves of the zero vector are alike, which is
what a triangular carrier makes of three duties with their extremes centred.

Source: Holmes, Lipo 2003, "Pulse width modulation for power converters", chapter 6.
"""

import math
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.errors import ScenarioError
from railjoule.core.simulate.field_oriented.run import FieldOrientedRun

CARRIER_HZ = 1000.0
"""Assumed: what traction inverters of this size reach."""
SAMPLES_A_PERIOD = 100
LONGEST_WINDOW_S = 1.0
LEAD_IN_PERIODS = 300
"""So many periods of the carrier before the window, the direct current of switching on dies away."""
THIRD = 2.0 * math.pi / 3.0


@dataclass(frozen=True, eq=False)
class Ripple:
    """Phase a of one machine over a short window; arrays of shape (n,).

    Parameters
    ----------
    time_s : array
        On the plan's clock [s].
    phase_current_a, phase_voltage_v : array
        With the inverter that switches, voltage against the machine's star point [A, V].
    average_current_a : array
        With the average of the voltage over each period of the carrier [A].
    """

    time_s: FloatArray
    phase_current_a: FloatArray
    phase_voltage_v: FloatArray
    average_current_a: FloatArray


def current_ripple(run: FieldOrientedRun, at_s: float, window_s: float = 0.01) -> Ripple:
    """Return the current of a phase as a two-level inverter makes it.

    Parameters
    ----------
    run : FieldOrientedRun
        The run.
    at_s : float
        When the window begins, on the plan's clock [s].
    window_s : float
        How long it is [s].

    Raises
    ------
    ScenarioError
        If the window lies outside the run, or is too long.
    """
    first, last = float(run.time_s[0]), float(run.time_s[-1])
    if not first <= at_s <= last:
        raise ScenarioError(f"at_s = {at_s:g} must lie within the run, {first:.1f} to {last:.1f} s.")
    if not 0 < window_s <= LONGEST_WINDOW_S:
        raise ScenarioError(f"window_s = {window_s:g} must be above 0 and at most {LONGEST_WINDOW_S:g}.")
    machines = run.machines
    machine, circuit = machines.machine, machines.circuit
    speed, i_d, i_q, flux = (
        float(np.interp(at_s, run.time_s, values))
        for values in (run.speed_ms, run.flux_current_a, run.torque_current_a, run.rotor_flux_vs)
    )
    psi = flux * circuit.magnetising_inductance_h / machine.mutual_inductance_h
    rotor_rads = machine.pole_pairs * machines.turns_per_metre * speed
    steps = max(round(window_s * CARRIER_HZ * SAMPLES_A_PERIOD), 2)
    found = np.empty((3, steps))
    _fill_ripple(
        np.array(
            [
                circuit.stator_resistance_ohm,
                circuit.rotor_resistance_ohm,
                circuit.magnetising_inductance_h,
                circuit.leakage_inductance_h,
            ]
        ),
        math.sqrt(3.0) * machine.max_phase_voltage_v,
        rotor_rads,
        i_d,
        i_q,
        psi,
        1.0 / (CARRIER_HZ * SAMPLES_A_PERIOD),
        found,
    )
    time = at_s + np.arange(steps) / (CARRIER_HZ * SAMPLES_A_PERIOD)
    return Ripple(frozen_array(time), frozen_array(found[0]), frozen_array(found[1]), frozen_array(found[2]))


@njit(cache=True)
def _leg_duties(link_v: float, alpha_v: float, beta_v: float) -> tuple[float, float, float]:
    """Return how much of a period each leg lies at the upper rail, the extremes centred."""
    root = 0.5 * math.sqrt(3.0)
    a, b, c = alpha_v, -0.5 * alpha_v + root * beta_v, -0.5 * alpha_v - root * beta_v
    shift = -0.5 * (max(a, b, c) + min(a, b, c))
    return (
        min(max(0.5 + (a + shift) / link_v, 0.0), 1.0),
        min(max(0.5 + (b + shift) / link_v, 0.0), 1.0),
        min(max(0.5 + (c + shift) / link_v, 0.0), 1.0),
    )


@njit(cache=True)
def _fill_ripple(
    circuit: FloatArray,
    link_v: float,
    rotor_rads: float,
    flux_current_a: float,
    torque_current_a: float,
    flux_vs: float,
    step_s: float,
    found: FloatArray,
) -> None:
    """Fill current and voltage of phase a with switching, and its average current; shape (3, n).

    Parameters
    ----------
    circuit : array of shape (4,)
        Resistances of stator and rotor [ohm], magnetising and leakage inductance [H] of the inverse-gamma circuit.
    link_v : float
        Voltage of the direct-current link [V].
    rotor_rads : float
        Electrical angular frequency of the rotor [rad/s].
    flux_current_a, torque_current_a, flux_vs : float
        Currents and rotor flux at the start [A, V s].
    step_s : float
        From one sample to the next [s].
    found : array of shape (3, n)
        Filled.
    """
    r_s, r_r, l_m, l_s = circuit
    slip = r_r * torque_current_a / flux_vs if flux_vs > 0.0 else 0.0
    frame = rotor_rads + slip
    u_d = r_s * flux_current_a - frame * l_s * torque_current_a
    u_q = r_s * torque_current_a + frame * (l_s * flux_current_a + flux_vs)
    lead = LEAD_IN_PERIODS * SAMPLES_A_PERIOD
    back = complex(math.cos(frame * lead * step_s), -math.sin(frame * lead * step_s))
    switched_i, switched_psi = complex(flux_current_a, torque_current_a) * back, flux_vs * back
    average_i, average_psi = switched_i, switched_psi
    duty_a = duty_b = duty_c = 0.5
    reach = 0.5 * SAMPLES_A_PERIOD
    # a voltage that stands still for a period is worth less than one that turns with the flux
    half_turn = frame * reach * step_s
    raised = half_turn / math.sin(half_turn) if abs(half_turn) > 1e-6 else 1.0
    decay = complex(-(r_s + r_r), 0.0)
    pull = complex(r_r / l_m, -rotor_rads)
    turn = complex(-r_r / l_m, rotor_rads)
    for i in range(-lead, found.shape[1]):
        inside = i % SAMPLES_A_PERIOD
        if inside == 0:
            # the voltage wanted in the middle of the period, at its two levels on average over it
            angle = frame * (i + reach) * step_s
            wanted = raised * complex(u_d, u_q) * complex(math.cos(angle), math.sin(angle))
            duty_a, duty_b, duty_c = _leg_duties(link_v, wanted.real, wanted.imag)
        # a leg is up where the triangle lies below its duty; within a sample the share of it counts
        a = _share_up(duty_a, inside)
        b = _share_up(duty_b, inside)
        c = _share_up(duty_c, inside)
        voltage = complex(link_v * (2.0 * a - b - c) / 3.0, link_v * (b - c) / math.sqrt(3.0))
        angle = frame * (i + 0.5) * step_s
        smooth = complex(u_d, u_q) * complex(math.cos(angle), math.sin(angle))
        if i >= 0:
            found[0, i], found[1, i], found[2, i] = switched_i.real, voltage.real, average_i.real
        for part in range(2):
            current = switched_i if part == 0 else average_i
            psi = switched_psi if part == 0 else average_psi
            u = voltage if part == 0 else smooth
            half_i = current + 0.5 * step_s * (u + decay * current + pull * psi) / l_s
            half_psi = psi + 0.5 * step_s * (r_r * current + turn * psi)
            current = current + step_s * (u + decay * half_i + pull * half_psi) / l_s
            psi = psi + step_s * (r_r * half_i + turn * half_psi)
            if part == 0:
                switched_i, switched_psi = current, psi
            else:
                average_i, average_psi = current, psi


@njit(cache=True)
def _share_up(duty: float, inside: int) -> float:
    """Return how much of a sample a leg lies at the upper rail, its pulse in the middle of the period."""
    first, last = 0.5 * SAMPLES_A_PERIOD * (1.0 - duty), 0.5 * SAMPLES_A_PERIOD * (1.0 + duty)
    return min(max(min(last, inside + 1.0) - max(first, float(inside)), 0.0), 1.0)
