"""A train and its induction machines: rates of motion, currents, fluxes and energies.

The frame is that of the control: it turns with the rotor flux that the control assumes, so a wrong rotor resistance
leaves the true flux with a part along both axes. The machine is that of the inverse-gamma circuit,

    Ls di/dt   = u - (Rs + Rr) i - j wc Ls i + (a - j p w) psi          a = Rr / Lm
    dpsi/dt    = Rr i - (a + j (wc - p w)) psi
    torque     = (3/2) p Im(i conj(psi))

with the rotor flux psi and the speed of the frame wc, which the control sets.

Source: Ftorek et al. 2025, Figure 1; Vittek et al. 2017, "Position tracking systems for AC drives employing forced
dynamics control".
"""

from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.simulation.field_oriented.states import State

# Friction has a direction of its own, so it would jump at a stand and let the integration chatter between two signs.
# Below this speed it is proportional to the speed instead: a train on a gradient creeps by less than that, a centimetre
# a second, where a real one stands. A larger value would show in the place of the stop, a smaller one asks for
# shorter steps.
CREEP_MS = 0.01


class Plant(NamedTuple):
    """The numbers of train, machines and control.

    Parameters
    ----------
    stator_resistance_ohm, rotor_resistance_ohm : float
        Of the inverse-gamma circuit [ohm].
    magnetising_inductance_h, leakage_inductance_h : float
        Of the same [H].
    pole_pairs, motors, turns_per_metre, gear_efficiency, mechanical_loss_torque_nm : float
        As in `railjoule.core.drive.induction`.
    hysteresis_loss_ws, eddy_loss_ws2, rated_flux_vs : float
        Iron losses at the rated flux, that of the inverse-gamma circuit [W s, W s2, V s].
    driving_current_a, braking_current_a, max_phase_voltage_v : float
        Limits of the inverter [A, V].
    recuperation_factor : float
        Fraction of the generated energy that the supply takes back.
    inertia_kg, assumed_inertia_kg : float
        Mass that resists acceleration, true and as the control knows it [kg].
    resistance_constant_n, resistance_linear : float
        Of the running resistance [N, N s/m].
    bandwidth_rads : float
        wp, the triple pole of the position control [rad/s].
    precompensator : bool
        Whether the lag is cancelled.
    rotor_resistance_factor : float
        Assumed rotor resistance over the true one.
    """

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    magnetising_inductance_h: float
    leakage_inductance_h: float
    pole_pairs: float
    motors: float
    turns_per_metre: float
    gear_efficiency: float
    mechanical_loss_torque_nm: float
    hysteresis_loss_ws: float
    eddy_loss_ws2: float
    rated_flux_vs: float
    driving_current_a: float
    braking_current_a: float
    max_phase_voltage_v: float
    recuperation_factor: float
    inertia_kg: float
    assumed_inertia_kg: float
    resistance_constant_n: float
    resistance_linear: float
    bandwidth_rads: float
    precompensator: bool
    rotor_resistance_factor: float


class Track(NamedTuple):
    """The track under the train, cell by cell.

    Parameters
    ----------
    border_m : array of shape (n + 1,)
        Borders of the cells [m].
    gradient_force_n, curve_force_n, resistance_quadratic : array of shape (n,)
        Force against the train in each cell, and what multiplies the square of the speed [N, N, N s2/m2].
    """

    border_m: FloatArray
    gradient_force_n: FloatArray
    curve_force_n: FloatArray
    resistance_quadratic: FloatArray


class Ground(NamedTuple):
    """One cell of the track; all as in `Track`."""

    gradient_force_n: float
    curve_force_n: float
    resistance_quadratic: float


class MachineRates(NamedTuple):
    """How one machine changes under a voltage, and the torque that it has.

    Parameters
    ----------
    current_d, current_q : float
        Rates of the stator current along and across the assumed flux [A/s].
    flux_d, flux_q : float
        Rates of the rotor flux [V].
    torque_nm : float
        Electromagnetic torque [N m].
    """

    current_d: float
    current_q: float
    flux_d: float
    flux_q: float
    torque_nm: float


class TrainForces(NamedTuple):
    """Forces on the train and what they make of its speed.

    Parameters
    ----------
    running_n, curve_n, gradient_n : float
        Resistances [N].
    friction_nm : float
        Friction of each machine [N m].
    wheel_n : float
        Force of all machines at the wheels [N].
    acceleration_ms2 : float
        Rate of the speed [m/s2].
    """

    running_n: float
    curve_n: float
    gradient_n: float
    friction_nm: float
    wheel_n: float
    acceleration_ms2: float


class Powers(NamedTuple):
    """Where the input power of all machines goes [W].

    Parameters
    ----------
    input_w, shaft_w : float
        At the terminals of all machines with their iron loss, and at their shafts.
    stator_w, rotor_w, magnetising_w, iron_w, mechanical_w, gear_w : float
        Losses: copper of the stator but for magnetising, copper of the rotor, magnetising, iron, friction, gear.
    running_w, curve_w, climb_w : float
        Work against running resistance, curves and gradients.
    """

    input_w: float
    shaft_w: float
    stator_w: float
    rotor_w: float
    magnetising_w: float
    iron_w: float
    mechanical_w: float
    gear_w: float
    running_w: float
    curve_w: float
    climb_w: float


@njit(cache=True, error_model="numpy", forceinline=True)
def wheel_force_n(plant: Plant, torque_nm: float) -> float:
    """Return the force of all machines at the wheels [N] at a torque of each shaft [N m]."""
    ideal = plant.motors * plant.turns_per_metre * torque_nm
    force: float = ideal * plant.gear_efficiency if torque_nm > 0.0 else ideal / plant.gear_efficiency
    return force


@njit(cache=True, error_model="numpy", forceinline=True)
def shaft_torque_nm(plant: Plant, force_n: float) -> float:
    """Return the torque of each shaft [N m] that gives a force of the train at the wheels [N]."""
    ideal = force_n / (plant.motors * plant.turns_per_metre)
    torque: float = ideal / plant.gear_efficiency if force_n > 0.0 else ideal * plant.gear_efficiency
    return torque


@njit(cache=True, error_model="numpy", forceinline=True)
def machine_rates(plant: Plant, state: State, voltage_d: float, voltage_q: float, frame_rads: float) -> MachineRates:
    """Return the rates of currents and fluxes under a voltage [V] in a frame that turns [rad/s].

    The iron has no branch in this circuit: its loss neither damps the flux nor brakes the rotor, and is added to
    the input power instead, as in `railjoule.core.drive.induction`.
    """
    i_d, i_q, psi_d, psi_q = state.current_d, state.current_q, state.flux_d, state.flux_q
    r_s, r_r = plant.stator_resistance_ohm, plant.rotor_resistance_ohm
    l_m, l_s, p = plant.magnetising_inductance_h, plant.leakage_inductance_h, plant.pole_pairs
    w = plant.turns_per_metre * state.speed_ms
    slip = frame_rads - p * w
    return MachineRates(
        current_d=(voltage_d - (r_s + r_r) * i_d + frame_rads * l_s * i_q + r_r / l_m * psi_d + p * w * psi_q) / l_s,
        current_q=(voltage_q - (r_s + r_r) * i_q - frame_rads * l_s * i_d + r_r / l_m * psi_q - p * w * psi_d) / l_s,
        flux_d=r_r * i_d - r_r / l_m * psi_d + slip * psi_q,
        flux_q=r_r * i_q - r_r / l_m * psi_q - slip * psi_d,
        torque_nm=1.5 * p * (i_q * psi_d - i_d * psi_q),
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def train_forces(plant: Plant, ground: Ground, speed_ms: float, torque_nm: float) -> TrainForces:
    """Return the forces on a train at a speed [m/s] and an electromagnetic torque of each machine [N m]."""
    direction = min(max(speed_ms / CREEP_MS, -1.0), 1.0)
    running = direction * running_resistance(
        plant.resistance_constant_n,
        plant.resistance_linear,
        ground.resistance_quadratic,
        abs(speed_ms),
        speed_ms * speed_ms,
    )
    curve = ground.curve_force_n * direction
    gradient = ground.gradient_force_n
    friction = plant.mechanical_loss_torque_nm * direction
    wheel = wheel_force_n(plant, torque_nm - friction)
    return TrainForces(
        running_n=running,
        curve_n=curve,
        gradient_n=gradient,
        friction_nm=friction,
        wheel_n=wheel,
        acceleration_ms2=(wheel - running - curve - gradient) / plant.inertia_kg,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def iron_loss_w(plant: Plant, flux2: float, frame_rads: float) -> float:
    """Return the iron loss of one machine [W] at a square of its flux [V2 s2] that turns [rad/s]."""
    turning = abs(frame_rads)
    loss: float = (plant.hysteresis_loss_ws + plant.eddy_loss_ws2 * turning) * turning
    return loss * flux2 / plant.rated_flux_vs**2


@njit(cache=True, error_model="numpy", forceinline=True)
def powers(
    plant: Plant, state: State, voltage: tuple[float, float], frame_rads: float, torque_nm: float, train: TrainForces
) -> Powers:
    """Return where the power goes under a voltage [V, V] in a frame that turns [rad/s], at a torque [N m]."""
    v, i_d, i_q, psi_d, psi_q = state.speed_ms, state.current_d, state.current_q, state.flux_d, state.flux_q
    u_d, u_q = voltage
    w, motors = plant.turns_per_metre * v, plant.motors
    r_s, r_r, l_m = plant.stator_resistance_ohm, plant.rotor_resistance_ohm, plant.magnetising_inductance_h
    # Re(u conj(i)), with u of the first circuit equation and psi conj(psi)' of the second put in, is
    #   Rs |i|^2 + Rr |i - psi / Lm|^2 + p w Im(i conj(psi)) + d/dt (Ls |i|^2 + |psi|^2 / Lm) / 2:
    # copper of the stator, copper of the rotor, whose current is psi / Lm - i, work at the shaft, and the magnetic
    # field. So input power and the sum of its parts agree but for what the steps of time leave.
    flux2 = psi_d * psi_d + psi_q * psi_q
    # the magnetising part of the stator's loss is that of the current along the true flux, whatever the control assumes
    along = (i_d * psi_d + i_q * psi_q) ** 2 / flux2 if flux2 > 0.0 else i_d * i_d + i_q * i_q
    whole = i_d * i_d + i_q * i_q
    rotor_d, rotor_q = i_d - psi_d / l_m, i_q - psi_q / l_m
    iron = iron_loss_w(plant, flux2, frame_rads)
    power = motors * (1.5 * (u_d * i_d + u_q * i_q) + iron)
    return Powers(
        input_w=power,
        shaft_w=motors * torque_nm * w,
        stator_w=motors * 1.5 * r_s * (whole - along),
        rotor_w=motors * 1.5 * r_r * (rotor_d * rotor_d + rotor_q * rotor_q),
        magnetising_w=motors * 1.5 * r_s * along,
        iron_w=motors * iron,
        mechanical_w=motors * train.friction_nm * w,
        gear_w=motors * (torque_nm - train.friction_nm) * w - train.wheel_n * v,
        running_w=train.running_n * v,
        curve_w=train.curve_n * v,
        climb_w=train.gradient_n * v,
    )
