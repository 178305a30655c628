"""What the closed loop integrates, and what it reports beside that: columns of its arrays.

The states are those of one machine, as all of them are alike; the energies are those of all machines and of the train.
"""

from typing import NamedTuple

(
    POSITION, SPEED, CURRENT_D, CURRENT_Q, FLUX_D, FLUX_Q,
    ASSUMED_FLUX, INTEGRAL_D, INTEGRAL_Q, REQUESTED_ACCELERATION, OBSERVED_SPEED, OBSERVED_LOAD,
    CLOCK, ELAPSED, FLUX_CURRENT_REDUCTION,
    INPUT, SHAFT, STATOR, ROTOR, MAGNETISING, IRON, DRAWN, RETURNED, MECHANICAL, GEAR, RUNNING, CURVE, CLIMB,
    STATES,
) = range(29)  # fmt: skip
"""The integrated states: train and machine, the control's own, its clocks, and from INPUT on energies [J]."""

VOLTAGE, TORQUE, LINE_POWER, CURRENT_LIMITED, VOLTAGE_LIMITED, OUTPUTS = range(6)
"""Amplitude of the voltage [V], torque of a machine [N m], power [W], and 1 where a limit was at work, else 0."""

REFERENCE_POSITION, REFERENCE_SPEED, REFERENCE_ACCELERATION, REFERENCE_JERK, REFERENCE_FLUX, REFERENCE_FLUX_RATE = (
    range(6)
)
"""Columns of the reference's samples [m, m/s, m/s2, m/s3, V s, V]."""


class State(NamedTuple):
    """The states that rates depend on, by name.

    Parameters
    ----------
    position_m, speed_ms : float
        Of the train [m, m/s].
    current_d, current_q, flux_d, flux_q : float
        Stator current and rotor flux of a machine, along and across the assumed flux [A, V s].
    assumed_flux_vs : float
        Flux of the control's own model [V s].
    integral_d, integral_q : float
        Integrals of the current control [A/s].
    requested_acceleration_ms2, observed_speed_ms, observed_load_n : float
        Of position control and load observer [m/s2, m/s, N].
    clock_s : float
        Reading of the reference's clock [s].
    flux_current_reduction_a : float
        What is taken off the current along the flux where the voltage does not suffice [A].
    """

    position_m: float
    speed_ms: float
    current_d: float
    current_q: float
    flux_d: float
    flux_q: float
    assumed_flux_vs: float
    integral_d: float
    integral_q: float
    requested_acceleration_ms2: float
    observed_speed_ms: float
    observed_load_n: float
    clock_s: float
    flux_current_reduction_a: float
