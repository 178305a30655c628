"""Drive a plan in closed loop: reference, flux, plant, and what the run shows.

Source: Ftorek et al. 2025, section 2 and Figure 1.
"""

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.budget import current_budget, rounded_up
from railjoule.core.compilation import require_compiled
from railjoule.core.drive.induction.traction import TractionMachines, traction_machines
from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError
from railjoule.core.motion import Course, build_course
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.field_oriented import states as column
from railjoule.core.simulation.field_oriented.control import ReferenceSamples
from railjoule.core.simulation.field_oriented.driven import driven_trajectory
from railjoule.core.simulation.field_oriented.flux import FluxPlan, plan_flux
from railjoule.core.simulation.field_oriented.integration import (
    TOO_LONG,
    UNSTABLE,
    Outcome,
    RunSettings,
    run_plant,
)
from railjoule.core.simulation.field_oriented.notes import ARRIVAL_M, accounts_note, run_notes, saturations
from railjoule.core.simulation.field_oriented.plant import Plant, Track
from railjoule.core.simulation.field_oriented.record import Record
from railjoule.core.simulation.field_oriented.reference import PlannedMotion, Reference, make_reference
from railjoule.core.simulation.field_oriented.rolling_back import stranded_sentence
from railjoule.core.simulation.field_oriented.run import FieldOrientedRun
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory

# How many samples of a run are kept: a chart is about as many pixels wide, and energies come from all steps anyway.
SAMPLES = 3000
# How much later than planned a train may arrive before it counts as stranded: a minute for short runs, and twice the
# time. More only makes a refusal take longer.
OVERTIME_S, OVERTIME_RATIO = 60.0, 1.0
# Errors of the measured speed are drawn once and repeated: 2^18 of them last 262 s, longer than the loop remembers.
NOISE_SAMPLES = 1 << 18


def simulate_field_oriented(scenario: Scenario, plan: Trajectory | None = None) -> FieldOrientedRun:
    """Return what induction machines under field-oriented control make of a plan.

    Parameters
    ----------
    scenario : Scenario
        With its `[simulation]`; its disturbance may change load, resistance and line voltage.
    plan : Trajectory, optional
        What to follow; the scenario's own strategy where absent.

    Raises
    ------
    ScenarioError
        If the drive has no induction machine, the scenario asks for what is not simulated here, or for more steps
        of time than the current budget has.
    InfeasibleLineError
        If the train does not reach its end.
    SolverError
        If the loop does not stay stable.
    RailjouleError
        As `railjoule.core.solve` for the plan.
    """
    traction_machines(scenario.vehicle.drive)
    _refuse_what_is_not_simulated(scenario)
    require_compiled()
    planned = plan if plan is not None else solve(scenario)
    _require_few_steps(scenario, planned.travel_time_s)
    options, real = scenario.simulation, actual_vehicle(scenario)
    machines, course = traction_machines(real.vehicle.drive), build_course(real)
    reference = make_reference(planned, options.reference_window_s)
    # the flux is planned for the train that the control assumes, on the voltage that the machines find
    flux = plan_flux(reference, build_course(scenario), machines, options.flux == "least_loss")
    record = _run(scenario, machines, course, reference, flux, PlannedMotion.of(planned))
    actual = driven_trajectory(real, planned.strategy, course, machines, record)
    return _described(scenario, planned, actual, machines, course, flux, record)


def _refuse_what_is_not_simulated(scenario: Scenario) -> None:
    disturbance = scenario.disturbance
    for words, there in (
        # the loop begins with machines at rest
        ("timetable.entry_speed_kmh", scenario.timetable.entry_speed_kmh != 0),
        ("timetable.exit_speed_kmh", scenario.timetable.exit_speed_kmh != 0),
        ("line.neutral_sections", bool(scenario.line.neutral_sections)),
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
    """Refuse a plan that takes too long for the closed loop, or a step of time that is too short for the plan."""
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
    scenario: Scenario,
    machines: TractionMachines,
    course: Course,
    reference: Reference,
    flux: FluxPlan,
    plan: PlannedMotion,
) -> Record:
    """Return the samples of a run, or raise where it has no end."""
    step = scenario.simulation.loop_step_s
    nominal_s = reference.step_s * (len(reference.position_m) - 1)
    longest_s = nominal_s * (1 + OVERTIME_RATIO) + OVERTIME_S
    end = float(plan.position_m[-1])
    settings = RunSettings(
        time_step_s=step,
        end_m=end,
        arrival_m=max(end - ARRIVAL_M, 0.5 * end),
        steps_per_sample=max(int(np.ceil(nominal_s / step / SAMPLES)), 1),
    )
    # the memory is what ends a run that does not arrive: the loop stops where it is full
    size = int(longest_s / step / settings.steps_per_sample) + 2
    states, outputs = np.zeros((size, column.STATES)), np.zeros((size, column.OUTPUTS))
    samples = _reference_samples(reference, flux, plan)
    outcome = run_plant(
        _plant(scenario, machines, course),
        _track(course),
        samples,
        _noise_ms(scenario, machines),
        _start(samples, course, machines),
        settings,
        states,
        outputs,
    )
    kept = outcome.sample_count
    _require_arrival(scenario, machines, course, outcome, settings, longest_s, states[:kept, column.POSITION])
    time: FloatArray = reference.start_s + step * settings.steps_per_sample * np.arange(kept, dtype=np.float64)
    # the last sample is that of the stop, and lies between two others
    time[-1] = max(reference.start_s + states[kept - 1, column.ELAPSED], time[-2] + step)
    delay = _delay_s(reference, plan, samples.planned_m, settings, outcome, states[kept - 1], float(time[-1]))
    return Record(time, states[:kept], outputs[:kept], outcome.extremes, plan.position_at(time), delay)


def _require_arrival(
    scenario: Scenario,
    machines: TractionMachines,
    course: Course,
    outcome: Outcome,
    settings: RunSettings,
    longest_s: float,
    position_m: FloatArray,
) -> None:
    """Raise where the loop was unstable, or the train did not come to its end."""
    options = scenario.simulation
    if outcome.ending == UNSTABLE:
        raise SolverError(
            f"the closed loop does not stay stable with simulation.bandwidth_rads = {options.bandwidth_rads:g}, "
            f"rotor_resistance_factor = {options.rotor_resistance_factor:g} and "
            f"time_step_s = {settings.time_step_s:g}."
        )
    if outcome.ending == TOO_LONG:
        stranded = stranded_sentence(scenario, machines, course, position_m)
        raise InfeasibleLineError(
            stranded
            or f"after {longest_s:.0f} s the train stands or creeps at {position_m[-1]:.0f} m of "
            f"{settings.end_m:.0f} m: with {machines.driving_current_a:g} A and "
            f"{machines.machine.max_phase_voltage_v:g} V its machines cannot move it on."
        )


def _delay_s(
    reference: Reference,
    plan: PlannedMotion,
    planned_m: FloatArray,
    settings: RunSettings,
    outcome: Outcome,
    final_state: FloatArray,
    stop_s: float,
) -> float:
    """Return how much later than planned the train arrives [s]; where it overruns its end, how much later it stands."""
    if final_state[column.POSITION] > settings.end_m + ARRIVAL_M:
        return stop_s - float(plan.time_s[-1])
    planned_s = float(np.interp(settings.arrival_m, planned_m, reference.time_s))
    return reference.start_s + outcome.arrival_s - planned_s


def _reference_samples(reference: Reference, flux: FluxPlan, plan: PlannedMotion) -> ReferenceSamples:
    """Return the reference as the kernel reads it; the columns stand in the order of their names in `states`."""
    columns = {
        column.REFERENCE_POSITION: reference.position_m,
        column.REFERENCE_SPEED: reference.speed_ms,
        column.REFERENCE_ACCELERATION: reference.acceleration_ms2,
        column.REFERENCE_JERK: reference.jerk_ms3,
        column.REFERENCE_FLUX: flux.flux_vs,
        column.REFERENCE_FLUX_RATE: flux.rate_v,
    }
    # samples in rows, as the kernel reads all six numbers of one instant
    samples = np.ascontiguousarray(np.stack([columns[name] for name in sorted(columns)], axis=1))
    return ReferenceSamples(samples, plan.position_at(reference.time_s), reference.step_s)


def _track(course: Course) -> Track:
    # copies, as the course's arrays are read-only, for which numba would compile another kernel
    return Track(
        border_m=np.array(course.position_m),
        gradient_force_n=np.array(course.gradient_force_n),
        curve_force_n=np.array(course.curve_force_n),
        resistance_quadratic=np.array(course.data.resistance_quadratic),
    )


def _plant(scenario: Scenario, machines: TractionMachines, course: Course) -> Plant:
    machine, circuit, options, data = machines.machine, machines.circuit, scenario.simulation, course.data
    return Plant(
        stator_resistance_ohm=circuit.stator_resistance_ohm,
        rotor_resistance_ohm=circuit.rotor_resistance_ohm,
        magnetising_inductance_h=circuit.magnetising_inductance_h,
        leakage_inductance_h=circuit.leakage_inductance_h,
        pole_pairs=machine.pole_pairs,
        motors=float(machines.motors),
        turns_per_metre=machines.turns_per_metre,
        gear_efficiency=machines.gear_efficiency,
        mechanical_loss_torque_nm=machine.mechanical_loss_torque_nm,
        hysteresis_loss_ws=machine.hysteresis_loss_ws,
        eddy_loss_ws2=machine.eddy_loss_ws2,
        rated_flux_vs=circuit.magnetising_inductance_h * machine.magnetising_current_a,
        driving_current_a=machines.driving_current_a,
        braking_current_a=machines.braking_current_a,
        max_phase_voltage_v=machine.max_phase_voltage_v,
        recuperation_factor=data.recuperation_factor,
        inertia_kg=2 * data.half_inertia_kg,
        assumed_inertia_kg=scenario.vehicle.total_inertia_kg,
        resistance_constant_n=data.resistance_constant_n,
        resistance_linear=data.resistance_linear,
        bandwidth_rads=options.bandwidth_rads,
        precompensator=options.precompensator,
        rotor_resistance_factor=options.rotor_resistance_factor,
    )


def _noise_ms(scenario: Scenario, machines: TractionMachines) -> FloatArray:
    options = scenario.simulation
    if options.speed_noise_rads == 0:
        return np.zeros(1)
    drawn = np.random.default_rng(options.noise_seed).standard_normal(NOISE_SAMPLES)
    return drawn * options.speed_noise_rads / machines.turns_per_metre


def _start(reference: ReferenceSamples, course: Course, machines: TractionMachines) -> FloatArray:
    """Return a train that stands, with its machines magnetised and held against the gradient.

    The observer already knows the gradient, as that of a train that has been held there does; else it would
    roll back until the observer has found it.
    """
    state = np.zeros(column.STATES)
    first = reference.samples[0]
    state[column.POSITION] = first[column.REFERENCE_POSITION]
    state[column.FLUX_D] = state[column.ASSUMED_FLUX] = first[column.REFERENCE_FLUX]
    state[column.CURRENT_D] = first[column.REFERENCE_FLUX] / machines.circuit.magnetising_inductance_h
    state[column.OBSERVED_LOAD] = course.gradient_force_n[0]
    return state


def _described(
    scenario: Scenario,
    planned: Trajectory,
    actual: Trajectory,
    machines: TractionMachines,
    course: Course,
    flux: FluxPlan,
    record: Record,
) -> FieldOrientedRun:
    """Return all that a run shows."""
    stored, extremes, saturated = record.field_energy_j(machines), record.extremes, saturations(record)
    by_parts = record.state(column.SHAFT) + record.losses_j + stored
    end_m = float(planned.position_m[-1])
    # the flux of the T circuit, in which data sheets and papers state it
    flux_ratio = machines.circuit.magnetising_inductance_h / machines.machine.mutual_inductance_h
    return FieldOrientedRun(
        scenario=scenario,
        planned=planned,
        actual=actual,
        machines=machines,
        time_s=frozen_array(record.time_s),
        position_m=frozen_array(record.position_m),
        speed_ms=frozen_array(record.state(column.SPEED)),
        reference_position_m=frozen_array(record.planned_m),
        tracking_error_m=frozen_array(record.tracking_error_m),
        flux_current_a=frozen_array(record.state(column.CURRENT_D)),
        torque_current_a=frozen_array(record.state(column.CURRENT_Q)),
        rotor_flux_vs=frozen_array(record.rotor_flux_vs / flux_ratio),
        phase_voltage_v=frozen_array(record.outputs[:, column.VOLTAGE]),
        voltage_limit_v=machines.machine.max_phase_voltage_v,
        torque_nm=frozen_array(record.outputs[:, column.TORQUE]),
        line_power_w=frozen_array(record.outputs[:, column.LINE_POWER] + course.data.auxiliary_power_w),
        energy_by_input_power_j=frozen_array(record.state(column.INPUT)),
        energy_by_parts_j=frozen_array(by_parts),
        magnetising_so_far_j=frozen_array(record.state(column.MAGNETISING)),
        parts_j=_parts_j(record, float(stored[-1])),
        max_tracking_error_m=max(extremes.max_lag_m, -extremes.min_lag_m),
        final_error_m=record.final(column.POSITION) - end_m,
        max_current_a=extremes.current_a,
        max_torque_current_a=extremes.max_torque_current_a,
        min_torque_current_a=extremes.min_torque_current_a,
        max_phase_voltage_v=extremes.voltage_v,
        delay_s=record.delay_s,
        saturated=saturated,
        notes=(
            *run_notes(scenario, machines, flux, record, saturated, end_m),
            *accounts_note(record, by_parts),
        ),
    )


def _parts_j(record: Record, stored_j: float) -> dict[str, float]:
    """Return the parts of the input energy at the end [J]; their keys are those of the JSON."""
    return {
        "shaft": record.final(column.SHAFT),
        "stator_copper": record.final(column.STATOR),
        "rotor_copper": record.final(column.ROTOR),
        "magnetising": record.final(column.MAGNETISING),
        "iron": record.final(column.IRON),
        "stored": stored_j,
    }
