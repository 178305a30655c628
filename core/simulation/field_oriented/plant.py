"""A train and its induction machines: rates of motion, currents and fluxes, and all powers.

The frame is that of the control: it turns with the assumed rotor flux, so a wrong rotor resistance gives the true flux
a part along both axes. Space vectors are complex numbers, real along the assumed flux. The machine is that of the
inverse-gamma circuit,

    Ls di/dt   = u - (Rs + Rr + j wc Ls) i + (a - j p w) psi            a = Rr / Lm
    dpsi/dt    = Rr i - (a + j (wc - p w)) psi
    torque     = (3/2) p Im(i conj(psi))

with the rotor flux psi and the speed of the frame wc, which the control sets.

Source: Ftorek et al. 2025, Figure 1; Vittek et al. 2017, "Position tracking systems for AC drives employing forced
dynamics control".
"""

from typing import NamedTuple

from railjoule.core.compiled import njit
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.physics.resistance import running_resistance

# Friction has a direction of its own, so it would jump at a stand and let the integration chatter between two signs.
# Below this speed it is proportional to the speed instead: a train on a gradient creeps by less than that, a centimetre
# a second, where a real one stands. A larger value would show in the place of the stop, a smaller one asks for
# shorter steps.
CREEP_MS = 0.01


class Plant(NamedTuple):
    """The numbers of train, machines and control.

    Parameters
    ----------
    machines : TractionMachines
        The true machines.
    recuperation_factor : float
        Fraction of the generated energy that the supply takes back.
    inertia_kg, assumed_inertia_kg : float
        Mass that resists acceleration, true and assumed by the control [kg].
    resistance_constant_n, resistance_linear : float
        Of the running resistance [N, N s/m].
    bandwidth_rads : float
        wp, the triple pole of the position control [rad/s].
    precompensator : bool
        Whether the lag is cancelled.
    rotor_resistance_factor : float
        Assumed rotor resistance over the true one.
    """

    machines: TractionMachines
    recuperation_factor: float
    inertia_kg: float
    assumed_inertia_kg: float
    resistance_constant_n: float
    resistance_linear: float
    bandwidth_rads: float
    precompensator: bool
    rotor_resistance_factor: float


class State(NamedTuple):
    """The states that rates depend on.

    Parameters
    ----------
    position_m, speed_ms : float
        Of the train [m, m/s].
    current, flux : complex
        Stator current and rotor flux of a machine [A, V s].
    assumed_flux_vs : float
        Flux of the control's own model [V s].
    integral : complex
        Integral of the current control [A/s].
    requested_acceleration_ms2, observed_speed_ms, observed_load_n : float
        Of position control and load observer [m/s2, m/s, N].
    flux_current_reduction_a : float
        Reduction of the current along the flux where the voltage does not suffice [A].
    """

    position_m: float
    speed_ms: float
    current: complex
    flux: complex
    assumed_flux_vs: float
    integral: complex
    requested_acceleration_ms2: float
    observed_speed_ms: float
    observed_load_n: float
    flux_current_reduction_a: float


@njit(cache=True, error_model="numpy", forceinline=True)
def wheel_force_n(plant: Plant, torque_nm: float) -> float:
    """Return the force of all machines at the wheels [N] at a torque of each shaft [N m]."""
    machines = plant.machines
    ideal = machines.motors * machines.turns_per_metre * torque_nm
    return ideal * machines.gear_efficiency if torque_nm > 0.0 else ideal / machines.gear_efficiency


@njit(cache=True, error_model="numpy", forceinline=True)
def shaft_torque_nm(plant: Plant, force_n: float) -> float:
    """Return the torque of each shaft [N m] that gives a force of the train at the wheels [N]."""
    machines = plant.machines
    ideal = force_n / (machines.motors * machines.turns_per_metre)
    return ideal / machines.gear_efficiency if force_n > 0.0 else ideal * machines.gear_efficiency


@njit(cache=True, error_model="numpy", forceinline=True)
def machine_rates(plant: Plant, state: State, voltage: complex, frame_rads: float) -> tuple[complex, complex, float]:
    """Return the rates of current [A/s] and flux [V], and the torque [N m], of a machine in a turning frame.

    The iron has no branch in this circuit: its loss neither damps the flux nor brakes the rotor, and is added to
    the input power instead, as in `railjoule.core.drive.induction`.
    """
    circuit, pole_pairs = plant.machines.circuit, plant.machines.machine.pole_pairs
    i, psi, rotor_rads = state.current, state.flux, pole_pairs * plant.machines.turns_per_metre * state.speed_ms
    r_r, l_s = circuit.rotor_resistance_ohm, circuit.leakage_inductance_h
    decay, resistance = r_r / circuit.magnetising_inductance_h, circuit.stator_resistance_ohm + r_r
    current_rate = voltage - complex(resistance, frame_rads * l_s) * i + complex(decay, -rotor_rads) * psi
    flux_rate = r_r * i - complex(decay, frame_rads - rotor_rads) * psi
    return (1.0 / l_s) * current_rate, flux_rate, 1.5 * pole_pairs * (i * psi.conjugate()).imag


@njit(cache=True, error_model="numpy", forceinline=True)
def electric_powers(
    plant: Plant, state: State, voltage: complex, frame_rads: float, torque_nm: float
) -> tuple[float, float, float, float, float, float]:
    """Return the powers of all machines [W].

    Input power with the iron loss, power at the shafts, and losses: copper of the stator but for magnetising, copper of
    the rotor, magnetising, iron.
    """
    i, psi, motors = state.current, state.flux, plant.machines.motors
    machine, circuit = plant.machines.machine, plant.machines.circuit
    r_s, r_r = circuit.stator_resistance_ohm, circuit.rotor_resistance_ohm
    # Re(u conj(i)), with u of the first circuit equation and psi conj(psi)' of the second put in, is
    #   Rs |i|^2 + Rr |i - psi / Lm|^2 + p w Im(i conj(psi)) + d/dt (Ls |i|^2 + |psi|^2 / Lm) / 2:
    # copper of the stator, copper of the rotor, whose current is psi / Lm - i, work at the shaft, and the magnetic
    # field. So input power and the sum of its parts agree but for the error of the steps of time.
    current2, flux2 = i.real * i.real + i.imag * i.imag, psi.real * psi.real + psi.imag * psi.imag
    # the magnetising part of the stator's loss is that of the current along the true flux, whatever the control assumes
    along2 = (i * psi.conjugate()).real ** 2 / flux2 if flux2 > 0.0 else current2
    rotor_current = i - (1.0 / circuit.magnetising_inductance_h) * psi
    turning = abs(frame_rads)
    rated_flux = circuit.magnetising_inductance_h * machine.magnetising_current_a
    iron = (machine.hysteresis_loss_ws + machine.eddy_loss_ws2 * turning) * turning * flux2 / rated_flux**2
    return (
        motors * (1.5 * (voltage * i.conjugate()).real + iron),
        motors * torque_nm * plant.machines.turns_per_metre * state.speed_ms,
        motors * 1.5 * r_s * (current2 - along2),
        motors * 1.5 * r_r * (rotor_current.real * rotor_current.real + rotor_current.imag * rotor_current.imag),
        motors * 1.5 * r_s * along2,
        motors * iron,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def train_motion(
    plant: Plant, ground: tuple[float, float, float], speed_ms: float, torque_nm: float
) -> tuple[float, float, float, float, float, float]:
    """Return the acceleration of a train [m/s2] and the powers that its machines spend on [W].

    These are friction of the machines, gear, running resistance, curves and gradients.

    Parameters
    ----------
    plant : Plant
    ground : tuple of three floats
        Gradient force, curve force and quadratic resistance of a cell [N, N, N s2/m2].
    speed_ms, torque_nm : float
        Speed of the train, electromagnetic torque of each machine [m/s, N m].
    """
    gradient, curve, quadratic = ground
    direction = min(max(speed_ms / CREEP_MS, -1.0), 1.0)
    running = direction * running_resistance(
        plant.resistance_constant_n, plant.resistance_linear, quadratic, abs(speed_ms), speed_ms * speed_ms
    )
    curve *= direction
    machines = plant.machines
    friction, shafts_rads = (
        machines.machine.mechanical_loss_torque_nm * direction,
        machines.motors * machines.turns_per_metre * speed_ms,
    )
    wheel = wheel_force_n(plant, torque_nm - friction)
    return (
        (wheel - running - curve - gradient) / plant.inertia_kg,
        friction * shafts_rads,
        (torque_nm - friction) * shafts_rads - wheel * speed_ms,
        running * speed_ms,
        curve * speed_ms,
        gradient * speed_ms,
    )
