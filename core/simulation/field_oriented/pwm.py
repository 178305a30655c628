"""A short window of a run with an inverter that switches: two levels, space vectors, sampled once a carrier period.

The machine is that of the inverse-gamma circuit in the frame of the stator. Speed, flux and the requested voltage
are those of the run at its start; the voltage turns with the flux. Both halves of the zero vector are alike, which is
what a triangular carrier makes of three duties with their extremes centred.

Source: Holmes, Lipo 2003, "Pulse width modulation for power converters", chapter 6.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.errors import ScenarioError
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun

# Assumed: what traction inverters of this size reach. The ripple of the current is proportional to its period, as the
# leakage inductance integrates the difference of the voltages: at 500 Hz it would be twice as large.
CARRIER_HZ = 1000.0
# Samples of the current in a period: pulses are counted in parts of a sample, so they set the resolution alone.
SAMPLES_PER_PERIOD = 100
# The state of the run is taken to be constant over the window; over a second its speed changes by some km/h already.
LONGEST_WINDOW_S = 1.0
# So many periods of the carrier before the window, in which the direct current of switching on dies away: 0.3 s are
# eight time constants Ls / (Rs + Rr) of Ftorek's machine, 37 ms, and more of the tram's.
LEAD_IN_PERIODS = 300


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
    samples = max(round(window_s * CARRIER_HZ * SAMPLES_PER_PERIOD), 2)
    step_s = 1.0 / (CARRIER_HZ * SAMPLES_PER_PERIOD)
    filled = np.empty((3, samples))
    _fill_ripple(
        _Circuit(
            stator_resistance_ohm=circuit.stator_resistance_ohm,
            rotor_resistance_ohm=circuit.rotor_resistance_ohm,
            magnetising_inductance_h=circuit.magnetising_inductance_h,
            leakage_inductance_h=circuit.leakage_inductance_h,
            rotor_rads=rotor_rads,
        ),
        # space vectors reach a phase amplitude of the link voltage over the root of three
        math.sqrt(3.0) * machine.max_phase_voltage_v,
        complex(i_d, i_q),
        psi,
        step_s,
        filled,
    )
    time = at_s + np.arange(samples) / (CARRIER_HZ * SAMPLES_PER_PERIOD)
    return Ripple(frozen_array(time), *(frozen_array(row) for row in filled))


class _Circuit(NamedTuple):
    """The inverse-gamma circuit of a machine whose rotor turns at a constant speed."""

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    magnetising_inductance_h: float
    leakage_inductance_h: float
    rotor_rads: float


@njit(cache=True)
def _leg_duties(link_v: float, alpha_v: float, beta_v: float) -> tuple[float, float, float]:
    """Return the duty of each leg, the fraction of a period at the upper rail, with the extremes centred."""
    root = 0.5 * math.sqrt(3.0)
    # A shift of all legs alike does not reach the star point. Centred, the largest difference between two legs is all
    # that has to fit in the link: 15 % more voltage than sine waves around its middle.
    a, b, c = alpha_v, -0.5 * alpha_v + root * beta_v, -0.5 * alpha_v - root * beta_v
    shift = -0.5 * (max(a, b, c) + min(a, b, c))
    return (
        min(max(0.5 + (a + shift) / link_v, 0.0), 1.0),
        min(max(0.5 + (b + shift) / link_v, 0.0), 1.0),
        min(max(0.5 + (c + shift) / link_v, 0.0), 1.0),
    )


@njit(cache=True)
def _turned(amount: complex, angle: float) -> complex:
    """Return a space vector turned by an angle [rad]."""
    return amount * complex(math.cos(angle), math.sin(angle))


@njit(cache=True)
def _steady_voltage(circuit: _Circuit, current: complex, flux_vs: float, frame_rads: float) -> complex:
    """Return the voltage [V] that keeps a current [A] and a rotor flux in a frame that turns with it.

    The voltage across the rotor's resistance is missing: in this frame the flux is constant, so none is across it.
    """
    r_s, l_s = circuit.stator_resistance_ohm, circuit.leakage_inductance_h
    return complex(
        r_s * current.real - frame_rads * l_s * current.imag,
        r_s * current.imag + frame_rads * (l_s * current.real + flux_vs),
    )


@njit(cache=True)
def _midpoint_step(
    circuit: _Circuit, current: complex, flux: complex, voltage: complex, step_s: float
) -> tuple[complex, complex]:
    """Return current and rotor flux after a step under a constant voltage, by the midpoint rule.

    In the frame of the stator a rotor flux that turns induces (a - j w) psi in its circuit. Second order suffices: a
    step is a hundredth of the carrier's period, and at most some thousandths of the circuit's time constants.
    """
    r_s, r_r, l_s = circuit.stator_resistance_ohm, circuit.rotor_resistance_ohm, circuit.leakage_inductance_h
    resistance = complex(-(r_s + r_r), 0.0)
    coupling = complex(r_r / circuit.magnetising_inductance_h, -circuit.rotor_rads)
    turning = complex(-r_r / circuit.magnetising_inductance_h, circuit.rotor_rads)
    half_current = current + 0.5 * step_s * (voltage + resistance * current + coupling * flux) / l_s
    half_flux = flux + 0.5 * step_s * (r_r * current + turning * flux)
    return (
        current + step_s * (voltage + resistance * half_current + coupling * half_flux) / l_s,
        flux + step_s * (r_r * half_current + turning * half_flux),
    )


@njit(cache=True)
def _switched_voltage(link_v: float, duties: tuple[float, float, float], sample: int) -> complex:
    """Return the voltage of the machine over one sample of a period [V], against its star point."""
    # a leg is up where the triangle lies below its duty; within a sample the part of it counts
    a = _part_up(duties[0], sample)
    b = _part_up(duties[1], sample)
    c = _part_up(duties[2], sample)
    return complex(link_v * (2.0 * a - b - c) / 3.0, link_v * (b - c) / math.sqrt(3.0))


@njit(cache=True)
def _fill_ripple(
    circuit: _Circuit, link_v: float, current: complex, flux_vs: float, step_s: float, filled: FloatArray
) -> None:
    """Fill current and voltage of phase a with switching, and its average current; shape (3, n).

    Parameters
    ----------
    circuit : _Circuit
        The machine.
    link_v : float
        Voltage of the direct-current link [V].
    current : complex
        Currents along and across the rotor flux at the start [A].
    flux_vs : float
        Rotor flux at the start [V s].
    step_s : float
        From one sample to the next [s].
    filled : array of shape (3, n)
        Filled.
    """
    slip = circuit.rotor_resistance_ohm * current.imag / flux_vs if flux_vs > 0.0 else 0.0
    frame = circuit.rotor_rads + slip
    steady = _steady_voltage(circuit, current, flux_vs, frame)
    lead = LEAD_IN_PERIODS * SAMPLES_PER_PERIOD
    # turned back by the lead-in, so that the flux lies along phase a where the window begins
    back = complex(math.cos(frame * lead * step_s), -math.sin(frame * lead * step_s))
    switched_current, switched_flux = current * back, flux_vs * back
    average_current, average_flux = switched_current, switched_flux
    duties = (0.5, 0.5, 0.5)
    half_period = 0.5 * SAMPLES_PER_PERIOD
    # A voltage that stands still for a period while the flux turns by 2 b is worth sin(b) / b of one that turns along:
    # the mean of cos over -b to b.
    half_turn = frame * half_period * step_s
    raised = half_turn / math.sin(half_turn) if abs(half_turn) > 1e-6 else 1.0
    for i in range(-lead, filled.shape[1]):
        sample = i % SAMPLES_PER_PERIOD
        if sample == 0:
            # the voltage requested in the middle of the period, at its two levels on average over it
            requested = _turned(raised * steady, frame * (i + half_period) * step_s)
            duties = _leg_duties(link_v, requested.real, requested.imag)
        voltage = _switched_voltage(link_v, duties, sample)
        smooth = _turned(steady, frame * (i + 0.5) * step_s)
        if i >= 0:
            filled[0, i], filled[1, i], filled[2, i] = switched_current.real, voltage.real, average_current.real
        switched_current, switched_flux = _midpoint_step(circuit, switched_current, switched_flux, voltage, step_s)
        average_current, average_flux = _midpoint_step(circuit, average_current, average_flux, smooth, step_s)


@njit(cache=True)
def _part_up(duty: float, sample: int) -> float:
    """Return for which part of a sample a leg lies at the upper rail, its pulse in the middle of the period."""
    first, last = 0.5 * SAMPLES_PER_PERIOD * (1.0 - duty), 0.5 * SAMPLES_PER_PERIOD * (1.0 + duty)
    return min(max(min(last, sample + 1.0) - max(first, float(sample)), 0.0), 1.0)
