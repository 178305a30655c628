"""Results of a closed-loop run from its samples: trajectory, energies, active limits and notes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.drive.line_power import line_power, resistor_power
from railjoule.core.energy import Energy, supply_current_a
from railjoule.core.motion import MeshedLine
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import Induction
from railjoule.core.simulation.field_oriented import loop
from railjoule.core.simulation.field_oriented.plant import CREEP_MS
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun, Saturation
from railjoule.core.trajectory import Trajectory

# Efforts are read off the vehicle's limits at no less than this speed, where a cell has no length.
SLOWEST_MS = 1e-3
# An arrival is measured so far before the end: the last decimetre is an asymptotic approach, whose time would
# depend more on the tolerance of standing than on the run.
ARRIVAL_M = 0.1
# Limits with a gap below the first are one event for a reader; shorter than the second they are none, if the train does
# not notice them either. Smaller values list each sample of a noisy run.
GAP_S, SHORT_S = 1.0, 0.1
# A lag of this size is mentioned: the loop's own stays below it, a platform's marks are coarser.
NOTICEABLE_LAG_M = 0.05
# A current above its limit by more than this factor is mentioned; below it is the overshoot of a control that works.
OVERSHOOT = 1.02
# Weakening by less is rounding of the flux that the voltage allows.
WEAKENED_FRACTION = 1 - 1e-6
# Both balances integrate the same stages, so their difference is the error of the steps of time.
ALLOWED_DIFFERENCE = 5e-4
ROLLED_BACK_M = 0.01
"""Rolling back by less is how the last samples approach the end [m]."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a run on the plan's clock; arrays of shape (n,).

    Parameters
    ----------
    time_s : array
        Times of the samples [s].
    states : array of shape (STATES, n)
        Rows as named in `railjoule.core.simulation.field_oriented.loop`.
    outputs : array of shape (OUTPUTS, n)
        Rows as named there.
    extremes : array of shape (2, 4)
        Least and greatest values of all steps, samples or not.
    tracking_error_m : array
        Distance of the train behind its plan [m].
    """

    time_s: FloatArray
    states: FloatArray
    outputs: FloatArray
    extremes: FloatArray
    tracking_error_m: FloatArray

    def field_energy_j(self, machines: TractionMachines) -> FloatArray:
        """Return the energy in the magnetic fields of all machines beyond that at the start [J]."""
        circuit, states = machines.circuit, self.states
        current2 = states[loop.CURRENT_D] ** 2 + states[loop.CURRENT_Q] ** 2
        flux2 = states[loop.FLUX_D] ** 2 + states[loop.FLUX_Q] ** 2
        per_machine = circuit.leakage_inductance_h * current2 + flux2 / circuit.magnetising_inductance_h
        # half of it is the energy of one phase's amplitudes, and amplitudes of three phases count 3/2 times
        stored: FloatArray = 0.75 * machines.motors * (per_machine - per_machine[0])
        return stored


def make_run(
    scenario: Scenario,
    planned: Trajectory,
    real: Scenario,
    mesh: MeshedLine,
    machines: TractionMachines,
    min_flux: float,
    samples: Samples,
    delay_s: float,
) -> FieldOrientedRun:
    """Return a run from its samples.

    Parameters
    ----------
    scenario, real : Scenario
        The simulated scenario, and the same with its actual vehicle.
    planned : Trajectory
        The plan.
    mesh, machines : MeshedLine, TractionMachines
        Track and machines as they are.
    min_flux : float
        Least flux that the voltage allows over the rated one.
    samples : Samples
        The samples.
    delay_s : float
        Delay of the arrival [s].
    """
    states, outputs = samples.states, samples.outputs
    least, greatest = samples.extremes
    stored, saturated = samples.field_energy_j(machines), saturations(samples)
    parts = {
        "shaft": states[loop.SHAFT],
        "stator_copper": states[loop.STATOR],
        "rotor_copper": states[loop.ROTOR],
        "magnetising": states[loop.MAGNETISING],
        "iron": states[loop.IRON],
        "stored": stored,
    }
    by_parts = np.sum(list(parts.values()), axis=0)
    end_m = float(planned.position_m[-1])
    # the flux of the T circuit, in which data sheets and papers state it
    flux_ratio = machines.circuit.magnetising_inductance_h / machines.machine.mutual_inductance_h
    return FieldOrientedRun(
        scenario=scenario,
        planned=planned,
        actual=driven_trajectory(real, planned.strategy, mesh, machines, samples),
        machines=machines,
        time_s=frozen_array(samples.time_s),
        position_m=frozen_array(states[loop.POSITION]),
        speed_ms=frozen_array(states[loop.SPEED]),
        tracking_error_m=frozen_array(samples.tracking_error_m),
        flux_current_a=frozen_array(states[loop.CURRENT_D]),
        torque_current_a=frozen_array(states[loop.CURRENT_Q]),
        rotor_flux_vs=frozen_array(np.hypot(states[loop.FLUX_D], states[loop.FLUX_Q]) / flux_ratio),
        phase_voltage_v=frozen_array(outputs[loop.VOLTAGE]),
        voltage_limit_v=machines.machine.max_phase_voltage_v,
        torque_nm=frozen_array(outputs[loop.TORQUE]),
        supply_power_w=frozen_array(outputs[loop.LINE_POWER] + mesh.data.auxiliary_power_w),
        energy_by_input_power_j=frozen_array(states[loop.INPUT]),
        energy_by_parts_j=frozen_array(by_parts),
        magnetising_so_far_j=frozen_array(states[loop.MAGNETISING]),
        parts_j={name: float(energy[-1]) for name, energy in parts.items()},
        max_tracking_error_m=float(max(greatest[loop.LAG_REACHED], -least[loop.LAG_REACHED])),
        max_current_a=float(greatest[loop.CURRENT_REACHED]),
        max_torque_current_a=float(greatest[loop.TORQUE_CURRENT_REACHED]),
        min_torque_current_a=float(least[loop.TORQUE_CURRENT_REACHED]),
        max_phase_voltage_v=float(greatest[loop.VOLTAGE_REACHED]),
        delay_s=delay_s,
        saturated=saturated,
        notes=(
            *_premises(scenario, machines, min_flux),
            *_limit_notes(machines, samples, saturated),
            *motion_notes(samples, end_m),
            *_control_notes(scenario, states[:, -1], float(by_parts[-1])),
        ),
    )


def driven_trajectory(
    real: Scenario, strategy: str, mesh: MeshedLine, machines: TractionMachines, samples: Samples
) -> Trajectory:
    """Return the run as a trajectory, over distance, in cells between its samples.

    A trajectory cannot go back: a train that rolls back is drawn as standing at its farthest place until it is there
    again. Times and energies are those of the run, and a note of the run explains it.

    Parameters
    ----------
    real : Scenario
        With the actual vehicle.
    strategy : str
        Strategy of the plan.
    mesh, machines : MeshedLine, TractionMachines
        Track and machines as they are.
    samples : Samples
        The samples.
    """
    data, states = mesh.data, samples.states
    time = samples.time_s - samples.time_s[0]
    position = np.maximum.accumulate(states[loop.POSITION])
    middle, duration = 0.5 * (position[1:] + position[:-1]), np.diff(time)
    mean_speed = np.maximum(np.diff(position) / duration, SLOWEST_MS)
    # the force at the wheels, as the integration has it
    direction = np.clip(states[loop.SPEED] / CREEP_MS, -1, 1)
    torque = samples.outputs[loop.TORQUE] - machines.machine.mechanical_loss_torque_nm * direction
    gear = np.where(torque > 0, machines.gear_efficiency, 1 / machines.gear_efficiency)
    force = machines.motors * machines.turns_per_metre * torque * gear
    effort = 0.5 * (force[1:] + force[:-1])
    # the rule of recuperation is linear on either side of zero, and the kernel integrates generated power separately
    # from drawn power, so it holds for the integral
    recuperated = -line_power(-states[loop.RETURNED], data.recuperation_factor)
    line = states[loop.DRAWN] - recuperated + data.auxiliary_power_w * time
    cell = np.clip(np.searchsorted(mesh.position_m, middle, side="right") - 1, 0, mesh.cell_count - 1)
    current_q = states[loop.CURRENT_Q]
    power_w = np.diff(line) / duration
    speed, final = states[loop.SPEED], states[:, -1]
    return Trajectory(
        scenario=real,
        strategy=strategy,
        position_m=frozen_array(position),
        speed_ms=frozen_array(np.maximum(speed, 0.0)),
        time_s=frozen_array(time),
        supply_energy_j=frozen_array(line),
        tractive_effort_n=frozen_array(np.maximum(effort, 0.0)),
        electric_braking_n=frozen_array(np.maximum(-effort, 0.0)),
        friction_braking_n=frozen_array(np.zeros_like(effort)),
        max_effort_n=frozen_array(data.traction.effort_n(mean_speed)),
        max_braking_n=frozen_array(data.braking.effort_n(mean_speed) + data.friction_effort_n),
        supply_power_w=frozen_array(power_w),
        current_a=frozen_array(0.5 * (current_q[1:] + current_q[:-1])),
        gradient_permille=frozen_array(mesh.gradient_permille[cell]),
        energy=Energy(
            traction_j=float(final[loop.DRAWN]),
            recuperated_j=float(recuperated[-1]),
            auxiliary_j=data.auxiliary_power_w * float(time[-1]),
            running_resistance_j=float(final[loop.RUNNING]),
            curve_resistance_j=float(final[loop.CURVE]),
            losses_j={
                "copper": float(final[loop.STATOR] + final[loop.ROTOR]),
                "magnetising": float(final[loop.MAGNETISING]),
                "iron": float(final[loop.IRON]),
                "mechanical": float(final[loop.MECHANICAL]),
                "gear": float(final[loop.GEAR]),
                "brake_resistors": float(resistor_power(-final[loop.RETURNED], data.recuperation_factor)),
            },
            kinetic_j=float(data.half_inertia_kg * (speed[-1] ** 2 - speed[0] ** 2)),
            potential_j=float(final[loop.CLIMB]),
            magnetic_field_j=float(samples.field_energy_j(machines)[-1]),
        ),
        supply_current_a=supply_current_a(power_w, real.vehicle.line_voltage_v),
    )


def saturations(samples: Samples) -> tuple[Saturation, ...]:
    """Return the intervals in which a limit was active, short gaps bridged, in order of time."""
    spans: list[Saturation] = []
    time, error = samples.time_s, samples.tracking_error_m
    for what, limited in (("current", loop.CURRENT_LIMITED), ("voltage", loop.VOLTAGE_LIMITED)):
        at = np.flatnonzero(samples.outputs[limited] > 0)
        for active in np.split(at, np.flatnonzero(np.diff(time[at]) > GAP_S) + 1) if len(at) else ():
            # a flag stands for the steps since the sample before
            start, end = float(time[max(active[0] - 1, 0)]), float(time[active[-1]])
            lag = float(np.max(error[active[0] : active[-1] + 1]))
            if end - start >= SHORT_S or lag >= NOTICEABLE_LAG_M:
                spans.append(Saturation(start, end, what, lag))  # type: ignore[arg-type]
    return tuple(sorted(spans))


def _premises(scenario: Scenario, machines: TractionMachines, min_flux: float) -> Iterator[str]:
    yield "The machines are magnetised before the departure; the account begins with it."
    if scenario.vehicle.braking.friction_effort_kn > 0:
        yield "The machines do all the braking: friction brakes are not part of the loop."
    if isinstance(scenario.vehicle.drive, Induction) and scenario.simulation.flux == "constant":
        yield "The control keeps the maximum flux that the voltage allows; the plan assumes the flux of minimum loss."
    if min_flux < WEAKENED_FRACTION:
        yield (
            f"The limit of {machines.machine.max_phase_voltage_v:.0f} V per phase weakens the flux to "
            f"{100 * min_flux:.0f} % of its rated value."
        )


def _limit_notes(machines: TractionMachines, samples: Samples, saturated: tuple[Saturation, ...]) -> Iterator[str]:
    limits = {
        "current": f"{machines.driving_current_a:g} A driving or {machines.braking_current_a:g} A braking",
        "voltage": f"{machines.machine.max_phase_voltage_v:.0f} V per phase",
    }
    for span in saturated:
        if abs(span.lag_m) < NOTICEABLE_LAG_M:
            continue
        behind = "behind" if span.lag_m > 0 else "ahead of"
        start_m = float(np.interp(span.start_s, samples.time_s, samples.states[loop.POSITION]))
        yield (
            f"From {start_m:.0f} m, {span.start_s:.1f} s to {span.end_s:.1f} s, the {span.what} limit of "
            f"{limits[span.what]} holds the machines back; the train is up to {abs(span.lag_m):.2f} m {behind} "
            "the plan."
        )
    current = samples.extremes[1, loop.CURRENT_REACHED]
    largest = max(machines.driving_current_a, machines.braking_current_a)
    if current > OVERSHOOT * largest:
        yield (
            f"The current reaches {current:.0f} A, above the limit of {largest:g} A, where the voltage limit or "
            "the speed noise prevents its control."
        )


def motion_notes(samples: Samples, end_m: float) -> Iterator[str]:
    """Yield sentences on a train that passes its end [m] or rolls back."""
    position = samples.states[loop.POSITION]
    beyond = position[-1] - end_m
    if beyond > ARRIVAL_M:
        yield f"The train overshoots its end by {beyond:.1f} m: its machines do not brake as planned."
    farthest = np.maximum.accumulate(position)
    back = farthest - position
    deepest = int(np.argmax(back))
    if back[deepest] > ROLLED_BACK_M:
        yield (
            f"The train rolls back by up to {back[deepest]:.2f} m from {farthest[deepest]:.0f} m, "
            f"{samples.time_s[deepest]:.1f} s: curves over distance show it standing there; its energy counts."
        )


def _control_notes(scenario: Scenario, final: FloatArray, by_parts_j: float) -> Iterator[str]:
    """Yield sentences on a wrong model of the control, and on balances that differ at the end."""
    factor = scenario.simulation.rotor_resistance_factor
    if factor != 1:
        yield f"The controller assumes {factor:g} times the true rotor resistance, so its flux axis is wrong."
    moved = max(final[loop.DRAWN] + final[loop.RETURNED], 1.0)
    difference = abs(by_parts_j - final[loop.INPUT]) / moved
    if difference > ALLOWED_DIFFERENCE:
        yield (
            f"The energy of the input power and the sum of its parts differ by {100 * difference:.2f} %: the "
            "simulation's time step is too long for the currents."
        )
