"""A short window of a run with an inverter that switches: two levels, space vectors, sampled once a carrier period.

The machine is that of the inverse-gamma circuit in the frame of the stator. Speed, flux and the requested voltage
are those of the run at its start; the voltage turns with the flux. Both halves of the zero vector are alike, which is
the result of a triangular carrier and three duties with their extremes centred.

Source: Holmes, Lipo 2003, "Pulse width modulation for power converters", chapter 6.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import ComplexArray, FloatArray, IntArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.errors import ScenarioError
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun

# Assumed: what traction inverters of this size reach. The ripple of the current is proportional to its period, as the
# leakage inductance integrates the difference of the voltages: at 500 Hz it would be twice as large.
CARRIER_HZ = 1000.0
# Samples of the current in a period: pulses are counted in parts of a sample, so they only set the resolution.
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
    """Return the current of a phase under a two-level inverter.

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
    machine, circuit = run.machines.machine, run.machines.circuit
    speed, i_d, i_q, t_flux = (
        float(np.interp(at_s, run.time_s, values))
        for values in (run.speed_ms, run.flux_current_a, run.torque_current_a, run.rotor_flux_vs)
    )
    r_s, r_r = circuit.stator_resistance_ohm, circuit.rotor_resistance_ohm
    l_s, decay = circuit.leakage_inductance_h, r_r / circuit.magnetising_inductance_h
    current, flux = complex(i_d, i_q), t_flux * circuit.magnetising_inductance_h / machine.mutual_inductance_h
    rotor = machine.pole_pairs * run.machines.turns_per_metre * speed
    frame = rotor + (r_r * i_q / flux if flux > 0 else 0.0)
    # the voltage that keeps current and flux in a frame that turns with them, where no voltage is across the rotor's
    # resistance
    steady = (r_s + 1j * frame * l_s) * current + 1j * frame * flux

    step_s = 1.0 / (CARRIER_HZ * SAMPLES_PER_PERIOD)
    count = max(round(window_s / step_s), 2)
    lead = LEAD_IN_PERIODS * SAMPLES_PER_PERIOD
    sample = np.arange(-lead, count)
    # space vectors reach a phase amplitude of the link voltage over the root of three
    switched = _switched_voltage(math.sqrt(3.0) * machine.max_phase_voltage_v, steady, frame * step_s, sample)
    average = np.asarray(steady * np.exp(1j * frame * step_s * (sample + 0.5)), dtype=np.complex128)
    # In the frame of the stator a rotor flux that turns induces (a - j w) psi in its circuit. The midpoint rule is
    # exact to second order, which suffices: a step is a hundredth of the carrier's period, and at most some thousandths
    # of the circuit's time constants.
    rates = np.array([[-(r_s + r_r) / l_s, (decay - 1j * rotor) / l_s], [r_r, 1j * rotor - decay]])
    step = np.eye(2) + step_s * rates + 0.5 * step_s**2 * rates @ rates
    drive = (step_s * np.eye(2) + 0.5 * step_s**2 * rates)[:, 0] / l_s
    # turned back by the lead-in, so that the flux lies along phase a where the window begins
    start = np.array([current, flux]) * np.exp(-1j * frame * lead * step_s)
    return Ripple(
        time_s=frozen_array(at_s + np.arange(count) * step_s),
        phase_current_a=frozen_array(_respond(step, drive, switched, start)[lead:].real),
        phase_voltage_v=frozen_array(switched[lead:].real),
        average_current_a=frozen_array(_respond(step, drive, average, start)[lead:].real),
    )


def _switched_voltage(link_v: float, steady: complex, angle: float, sample: IntArray) -> ComplexArray:
    """Return the voltages of the machine over samples of a period [V], against its star point.

    Parameters
    ----------
    link_v : float
        Voltage of the direct-current link [V].
    steady : complex
        Voltage requested in a frame that turns [V].
    angle : float
        By which the frame turns over a sample [rad].
    sample : array of shape (n,)
        Numbers of the samples; those divisible by `SAMPLES_PER_PERIOD` begin a period.
    """
    half_period = 0.5 * SAMPLES_PER_PERIOD
    # A voltage that stands still for a period while the flux turns by 2 b is worth sin(b) / b of one that turns along:
    # the mean of cos over -b to b.
    raised = steady / np.sinc(half_period * angle / np.pi)
    # the voltage requested in the middle of the period, at its two levels on average over it
    within = sample % SAMPLES_PER_PERIOD
    requested = raised * np.exp(1j * angle * (sample - within + half_period))
    legs = np.array([(requested * np.exp(-2j * np.pi * number / 3)).real for number in range(3)])
    # A shift of all legs alike does not reach the star point. Centred, the largest difference between two legs is all
    # that has to fit in the link: 15 % more voltage than sine waves around its middle.
    shift = 0.5 * (legs.max(axis=0) + legs.min(axis=0))
    duties = np.clip(0.5 + (legs - shift) / link_v, 0.0, 1.0)
    # a leg is up where the triangle lies below its duty, in the middle of the period; of a sample the part in it counts
    first, last = half_period * (1.0 - duties), half_period * (1.0 + duties)
    a, b, c = np.clip(np.minimum(last, within + 1.0) - np.maximum(first, within), 0.0, 1.0)
    voltage: ComplexArray = link_v * ((2.0 * a - b - c) / 3.0 + 1j * (b - c) / math.sqrt(3.0))
    return voltage


@njit(cache=True)
def _respond(step: Any, drive: Any, voltage: ComplexArray, start: Any) -> ComplexArray:
    """Return the currents of a circuit [A] at the beginning of samples with constant voltages [V]; shape (n,)."""
    currents = np.empty_like(voltage)
    current, flux = start[0], start[1]
    for k in range(len(voltage)):
        currents[k] = current
        before = current
        current = step[0, 0] * before + step[0, 1] * flux + drive[0] * voltage[k]
        flux = step[1, 0] * before + step[1, 1] * flux + drive[1] * voltage[k]
    return currents
