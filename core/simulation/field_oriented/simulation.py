"""Drive a plan in closed loop: reference, flux, plant, and the results of the run.

Source: Ftorek et al. 2025, section 2 and Figure 1.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.budget import current_budget, rounded_up
from railjoule.core.compilation import require_compiled
from railjoule.core.drive.induction.machine import torque_constant
from railjoule.core.drive.induction.traction import TractionMachines, traction_machines
from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import Induction
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.field_oriented import loop
from railjoule.core.simulation.field_oriented.plant import Plant
from railjoule.core.simulation.field_oriented.reference import (
    Reference,
    make_reference,
    plan_flux,
    planned_position_m,
)
from railjoule.core.simulation.field_oriented.results import ARRIVAL_M, ROLLED_BACK_M, Samples, make_run
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import N_PER_KN

# How many samples of a run are kept: a chart is about as many pixels wide, and energies come from all steps anyway.
SAMPLES = 3000
# How much later than planned a train may arrive before it counts as stranded: a minute for short runs, and twice the
# time. More only makes a refusal take longer.
OVERTIME_S, OVERTIME_RATIO = 60.0, 1.0
# Errors of the measured speed are drawn once and repeated: 2^18 of them last 262 s, longer than the loop remembers.
NOISE_SAMPLES = 1 << 18


def simulate_field_oriented(scenario: Scenario, plan: Trajectory | None = None) -> FieldOrientedRun:
    """Simulate a plan with induction machines under field-oriented control.

    Parameters
    ----------
    scenario : Scenario
        With its `[simulation]`; its disturbance may change load, resistance and supply voltage.
    plan : Trajectory, optional
        The plan to follow; that of the scenario's own strategy where absent.

    Raises
    ------
    ScenarioError
        If the drive has no induction machine, the scenario has features that are not simulated here, or needs more
        steps of time than the current budget has.
    InfeasibleLineError
        If the train does not reach its end.
    SolverError
        If the loop does not stay stable.
    RailjouleError
        As `railjoule.core.solve` for the plan.
    """
    traction_machines(scenario.vehicle.drive)
    _require_supported(scenario)
    require_compiled()
    planned = plan if plan is not None else solve(scenario)
    _require_few_steps(scenario, planned.travel_time_s)
    options, real = scenario.simulation, actual_vehicle(scenario)
    machines, mesh = traction_machines(real.vehicle.drive), build_meshed_line(real)
    reference = make_reference(planned, options.reference_window_s)
    # the flux is planned for the train that the control assumes, on the voltage that the machines have
    min_flux = plan_flux(reference, build_meshed_line(scenario), machines, options.flux == "min_loss")
    samples, delay_s = _run(scenario, machines, mesh, reference, planned)
    return make_run(scenario, planned, real, mesh, machines, min_flux, samples, delay_s)


def _require_supported(scenario: Scenario) -> None:
    """Raise ScenarioError for features that the closed loop does not simulate."""
    disturbance = scenario.disturbance
    for words, there in (
        # the loop begins with machines at rest
        ("timetable.entry_speed_kmh", scenario.timetable.entry_speed_kmh != 0),
        ("timetable.exit_speed_kmh", scenario.timetable.exit_speed_kmh != 0),
        ("line.neutral_sections", bool(scenario.line.neutral_sections)),
        ("line.traction_limits", bool(scenario.line.traction_limits)),
        ("line.rail_conditions", bool(scenario.line.rail_conditions)),
        ("vehicle.resistance.starting_ends_at_kmh", scenario.vehicle.resistance.starting_ends_at_kmh is not None),
        ("events on the way", bool(disturbance.events)),
        ("disturbance.coordinate_error_m", disturbance.coordinate_error_m != 0),
        ("disturbance.departure_delay_s", disturbance.departure_delay_s != 0),
        # the loop follows the plan over time by the motor's own sensor, not by an odometer over distance
        ("simulation.speed_error", scenario.simulation.speed_error != 0),
        ("simulation.sensor_errors_m", any(scenario.simulation.sensor_errors_m)),
    ):
        if there:
            raise ScenarioError(f"simulation.kind = field_oriented does not simulate {words}; kind = following does.")


def _require_few_steps(scenario: Scenario, duration_s: float) -> None:
    """Raise ScenarioError for a plan that takes too long, or a step of time that is too short for it."""
    budget, step = current_budget(), scenario.simulation.loop_step_s
    if duration_s > budget.loop_time_s:
        raise ScenarioError(
            f"A plan of {duration_s:,.0f} s is too long for the closed loop: {budget.name} takes at most "
            f"{budget.loop_time_s:,.0f} s."
        )
    if duration_s > budget.loop_steps * step:
        raise ScenarioError(
            f"simulation.time_step_s = {step:g} makes {duration_s / step:,.0f} steps; {budget.name} takes at most "
            f"{budget.loop_steps:,}. Use {rounded_up(duration_s / budget.loop_steps):g} s or more."
        )


def _run(
    scenario: Scenario, machines: TractionMachines, mesh: MeshedLine, reference: Reference, planned: Trajectory
) -> tuple[Samples, float]:
    """Return the samples of a run and the delay of its arrival [s].

    Raises
    ------
    InfeasibleLineError, SolverError
        As `simulate_field_oriented`.
    """
    options, data, step = scenario.simulation, mesh.data, scenario.simulation.loop_step_s
    nominal_s = reference.step_s * (len(reference.samples) - 1)
    longest_s = nominal_s * (1 + OVERTIME_RATIO) + OVERTIME_S
    end = float(planned.position_m[-1])
    arrival = max(end - ARRIVAL_M, 0.5 * end)
    steps_per_sample = max(int(np.ceil(nominal_s / step / SAMPLES)), 1)
    plant = Plant(
        machines=machines,
        recuperation_factor=data.recuperation_factor,
        inertia_kg=2 * data.half_inertia_kg,
        assumed_inertia_kg=scenario.vehicle.total_inertia_kg,
        resistance_constant_n=data.resistance_constant_n,
        resistance_linear=data.resistance_linear,
        bandwidth_rads=options.bandwidth_rads,
        precompensator=options.precompensator,
        rotor_resistance_factor=options.rotor_resistance_factor,
    )
    noise_ms = np.zeros(1)
    if options.speed_noise_rads > 0:
        drawn = np.random.default_rng(options.noise_seed).standard_normal(NOISE_SAMPLES)
        noise_ms = drawn * options.speed_noise_rads / machines.turns_per_metre
    # the memory is what ends a run that does not arrive: the loop stops where it is full
    size = int(longest_s / step / steps_per_sample) + 2
    states, outputs, extremes = np.zeros((size, loop.STATES)), np.zeros((size, loop.OUTPUTS)), np.zeros((2, 4))
    ending, kept, arrived_s = loop.run_plant(
        plant,
        # a copy, as the meshed line's arrays are read-only, for which numba would compile another kernel
        np.array(mesh.position_m),
        np.column_stack([mesh.gradient_force_n, mesh.curve_force_n, data.resistance_quadratic]),
        reference,
        noise_ms,
        _start(reference, mesh, machines),
        step,
        end,
        arrival,
        steps_per_sample,
        states,
        outputs,
        extremes,
    )
    states = states[:kept].T
    if ending == loop.UNSTABLE:
        raise SolverError(
            f"the closed loop does not stay stable with simulation.bandwidth_rads = {options.bandwidth_rads:g}, "
            f"rotor_resistance_factor = {options.rotor_resistance_factor:g} and time_step_s = {step:g}."
        )
    if ending == loop.TOO_LONG:
        raise InfeasibleLineError(
            _gradient_reason(scenario, machines, mesh, states[loop.POSITION])
            or f"after {longest_s:.0f} s the train stands or creeps at {states[loop.POSITION, -1]:.0f} m of "
            f"{end:.0f} m: with {machines.driving_current_a:g} A and {machines.machine.max_phase_voltage_v:g} V its "
            "machines cannot move it on."
        )
    time: FloatArray = reference.start_s + step * steps_per_sample * np.arange(kept, dtype=np.float64)
    # the last sample is that of the stop, and lies between two others
    time[-1] = max(reference.start_s + states[loop.ELAPSED, -1], time[-2] + step)
    samples = Samples(
        time, states, outputs[:kept].T, extremes, planned_position_m(planned, time) - states[loop.POSITION]
    )
    if states[loop.POSITION, -1] > end + ARRIVAL_M:
        return samples, float(time[-1] - planned.time_s[-1])
    planned_s = float(np.interp(arrival, reference.planned_m, reference.time_s))
    return samples, reference.start_s + arrived_s - planned_s


def _gradient_reason(scenario: Scenario, machines: TractionMachines, mesh: MeshedLine, position_m: FloatArray) -> str:
    """Return why a train rolls back or stands on a gradient; empty where its effort is enough to start there.

    No brake is part of the loop, so a train rolls back where its machines do not hold it.
    """
    place = max(float(np.max(position_m)), 0.0)
    rolls_back = place - position_m[-1] > ROLLED_BACK_M
    cell = int(np.clip(np.searchsorted(mesh.position_m, place, side="right") - 1, 0, mesh.cell_count - 1))
    needed = float(mesh.gradient_force_n[cell] + mesh.curve_force_n[cell]) + mesh.data.resistance_constant_n
    # of a standing train, at rated flux
    machine, amperes = machines.machine, machines.driving_current_a
    flux_current, friction = machine.magnetising_current_a, machine.mechanical_loss_torque_nm
    torque_per_ampere = torque_constant(machine) * flux_current
    force_per_torque = machines.motors * machines.turns_per_metre * machines.gear_efficiency
    torque_current = math.sqrt(max(amperes**2 - flux_current**2, 0.0))
    effort = force_per_torque * (torque_per_ampere * torque_current - friction)
    if effort >= needed and not rolls_back:
        return ""
    enough = math.hypot(flux_current, (needed / force_per_torque + friction) / torque_per_ampere)
    key = "starting_current_a" if isinstance(scenario.vehicle.drive, Induction) else "machine.max_current_a"
    limit = (
        f"with {amperes:g} A and {machine.max_phase_voltage_v:g} V its machines do not hold it."
        if effort >= needed
        else f"with drive.{key} = {amperes:g} its machines pull with {effort / N_PER_KN:.1f} kN at most. Use more than "
        f"{math.ceil(enough)} A, or a lighter train."
    )
    return (
        f"At {place:.0f} m, on a gradient of {mesh.gradient_permille[cell]:.4g} per mille, the train "
        f"{'rolls back' if rolls_back else 'comes to a stand'}: to start there takes {needed / N_PER_KN:.1f} kN, and "
        f"{limit}"
    )


def _start(reference: Reference, mesh: MeshedLine, machines: TractionMachines) -> FloatArray:
    """Return a train that stands, with its machines magnetised and held against the gradient.

    The observer already contains the gradient, as that of a train that has been held there does; else it would
    roll back until the observer has found it.
    """
    state, flux = np.zeros(loop.STATES), reference.samples[0, 4]
    state[loop.POSITION] = reference.samples[0, 0]
    state[loop.FLUX_D] = state[loop.ASSUMED_FLUX] = flux
    state[loop.CURRENT_D] = flux / machines.circuit.magnetising_inductance_h
    state[loop.OBSERVED_LOAD] = mesh.gradient_force_n[0]
    return state
