"""Drive a plan in closed loop: reference, flux, plant, and what the run tells.

Source: Ftorek et al. 2025, section 2 and Figure 1.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array
from railjoule.core.budget import current_budget, rounded_up
from railjoule.core.drive.induction.traction import TractionMachines, traction_machines
from railjoule.core.drive.line_power import line_power, resistor_power
from railjoule.core.energy import Energy
from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError
from railjoule.core.line_current import line_current_a
from railjoule.core.motion import Course, build_course
from railjoule.core.scenario import Scenario
from railjoule.core.simulate.as_it_is import as_it_is
from railjoule.core.simulate.field_oriented import plant as p
from railjoule.core.simulate.field_oriented.flux import FluxPlan, plan_flux
from railjoule.core.simulate.field_oriented.reference import PlannedMotion, Reference, make_reference
from railjoule.core.simulate.field_oriented.run import FieldOrientedRun, Saturation
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory

SAMPLES = 3000
"""How many samples of a run in time are kept."""
OVERTIME_S, OVERTIME_SHARE = 60.0, 1.0
"""How much later than planned a train may arrive before it counts as stranded."""
ARRIVAL_M = 0.1
"""So far before its end a train's delay is measured."""
NOISE_SAMPLES = 1 << 18
LARGEST_NOISY_STEP_S = 0.0005
"""Currents that follow noise never come to rest between two steps."""
GAP_S, SHORT_S = 1.0, 0.1
"""Limits at work less than the first apart are one event; alone, less than the second they are none."""
NOTICEABLE_LAG_M = 0.05
ALLOWED_DIFFERENCE = 5e-4
ACCOUNTS_APART = (
    "The energy of the input power and the sum of its parts differ by {:.2f} %: simulation.time_step_s is too long for "
    "the currents."
)
OVERSHOOT = 1.02
"""A current beyond its limit by more than this factor is told."""
SLOWEST_MS = 1e-3
WEAKENED_SHARE = 1 - 1e-6


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
    planned = plan if plan is not None else solve(scenario)
    _require_few_steps(scenario, planned.travel_time_s)
    options, real = scenario.simulation, as_it_is(scenario)
    machines, course = traction_machines(real.vehicle.drive), build_course(real)
    reference = make_reference(planned, options.reference_window_s)
    flux = plan_flux(reference, build_course(scenario), machines, options.flux == "least_loss")
    record = _run(scenario, machines, course, reference, flux, PlannedMotion.of(planned))
    return _told(scenario, real, planned, machines, course, flux, record)


@dataclass(frozen=True, eq=False)
class _Record:
    """What the kernel filled, on the plan's clock."""

    time_s: FloatArray
    states: FloatArray
    extras: FloatArray
    peaks: FloatArray
    planned_m: FloatArray
    delay_s: float


def _refuse_what_is_not_simulated(scenario: Scenario) -> None:
    disturbance = scenario.disturbance
    for words, there in (
        ("events on the way", bool(disturbance.events)),
        ("disturbance.coordinate_error_m", disturbance.coordinate_error_m != 0),
        ("disturbance.departure_delay_s", disturbance.departure_delay_s != 0),
    ):
        if there:
            raise ScenarioError(f"simulation.kind = field_oriented does not simulate {words}; kind = following does.")


def _require_few_steps(scenario: Scenario, duration_s: float) -> None:
    """Refuse a plan that takes too long for the closed loop, or a step of time that is too short for the plan."""
    budget, step = current_budget(), scenario.simulation.time_step_s
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
) -> _Record:
    options, step = scenario.simulation, scenario.simulation.time_step_s
    if options.speed_noise_rads > 0:
        step = min(step, LARGEST_NOISY_STEP_S)
    planned = plan.position_at(reference.time_s)
    way = p.Way(
        border_m=np.array(course.position_m),
        gradient_force_n=np.array(course.gradient_force_n),
        curve_force_n=np.array(course.curve_force_n),
        resistance_quadratic=np.array(course.data.resistance_quadratic),
        reference=np.ascontiguousarray(
            np.stack(
                [
                    reference.position_m,
                    reference.speed_ms,
                    reference.acceleration_ms2,
                    reference.jerk_ms3,
                    flux.flux_vs,
                    flux.rate_v,
                ],
                axis=1,
            )
        ),
        planned_m=planned,
        step_s=reference.step_s,
    )
    nominal_s = reference.step_s * (len(planned) - 1)
    keep_every = max(int(np.ceil(nominal_s / step / SAMPLES)), 1)
    longest_s = nominal_s * (1 + OVERTIME_SHARE) + OVERTIME_S
    size = int(longest_s / step / keep_every) + 2
    states, extras, peaks = np.zeros((size, p.STATES)), np.zeros((size, p.EXTRAS)), np.zeros(p.PEAKS)
    end = float(plan.position_m[-1])
    arrival = max(end - ARRIVAL_M, 0.5 * end)
    outcome, kept = p.run_plant(
        _plant(scenario, machines, course),
        way,
        _noise_ms(scenario, machines),
        _start(way, machines),
        step,
        end,
        arrival,
        keep_every,
        states,
        extras,
        peaks,
    )
    if outcome == p.UNSTABLE:
        raise SolverError(
            f"the closed loop does not stay stable with simulation.bandwidth_rads = {options.bandwidth_rads:g}, "
            f"rotor_resistance_factor = {options.rotor_resistance_factor:g} and time_step_s = {step:g}."
        )
    if outcome == p.TOO_LONG:
        raise InfeasibleLineError(
            f"after {longest_s:.0f} s the train stands or creeps at {states[kept - 1, p.X]:.0f} m of {end:.0f} m: "
            f"with {machines.driving_current_a:g} A and {machines.machine.max_phase_voltage_v:g} V its machines "
            "cannot move it on."
        )
    time: FloatArray = reference.start_s + step * keep_every * np.arange(kept, dtype=np.float64)
    # the last sample is that of the stop, and lies between two others
    time[-1] = max(reference.start_s + states[kept - 1, p.ELAPSED], time[-2] + step)
    if states[kept - 1, p.X] > end + ARRIVAL_M:
        delay = float(time[-1] - plan.time_s[-1])
    else:
        delay = reference.start_s + float(peaks[p.ARRIVAL]) - float(np.interp(arrival, planned, reference.time_s))
    return _Record(time, states[:kept], extras[:kept], peaks, plan.position_at(time), delay)


def _plant(scenario: Scenario, machines: TractionMachines, course: Course) -> p.Plant:
    machine, circuit, options, data = machines.machine, machines.circuit, scenario.simulation, course.data
    return p.Plant(
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
        believed_inertia_kg=scenario.vehicle.total_inertia_kg,
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


def _start(way: p.Way, machines: TractionMachines) -> FloatArray:
    """Return a train that stands, with its machines magnetised and held against the gradient."""
    state = np.zeros(p.STATES)
    state[p.X] = way.reference[0, 0]
    state[p.PSI_D] = state[p.BELIEVED_PSI] = way.reference[0, 4]
    state[p.ID] = way.reference[0, 4] / machines.circuit.magnetising_inductance_h
    state[p.SEEN_LOAD] = way.gradient_force_n[0]
    return state


def _told(
    scenario: Scenario,
    real: Scenario,
    planned: Trajectory,
    machines: TractionMachines,
    course: Course,
    flux: FluxPlan,
    record: _Record,
) -> FieldOrientedRun:
    states, extras, peaks = record.states, record.extras, record.peaks
    stored = _stored_j(machines, states)
    losses = sum(states[:, k] for k in (p.STATOR, p.ROTOR, p.MAGNETISING, p.IRON))
    by_parts = states[:, p.SHAFT] + losses + stored
    error = record.planned_m - states[:, p.X]
    saturated = _saturations(record, error)
    moved = states[-1, p.DRAWN] + states[-1, p.RETURNED]
    apart = abs(float(by_parts[-1] - states[-1, p.INPUT])) / max(float(moved), 1.0)
    circuit, machine = machines.circuit, machines.machine
    flux_ratio = circuit.magnetising_inductance_h / machine.mutual_inductance_h
    actual = _trajectory(real, planned, course, machines, record, float(stored[-1]))
    return FieldOrientedRun(
        scenario=scenario,
        planned=planned,
        actual=actual,
        machines=machines,
        time_s=frozen_array(record.time_s),
        position_m=frozen_array(states[:, p.X]),
        speed_ms=frozen_array(states[:, p.V]),
        reference_position_m=frozen_array(record.planned_m),
        tracking_error_m=frozen_array(error),
        flux_current_a=frozen_array(states[:, p.ID]),
        torque_current_a=frozen_array(states[:, p.IQ]),
        rotor_flux_vs=frozen_array(np.hypot(states[:, p.PSI_D], states[:, p.PSI_Q]) / flux_ratio),
        phase_voltage_v=frozen_array(extras[:, p.VOLTAGE]),
        voltage_limit_v=machine.max_phase_voltage_v,
        torque_nm=frozen_array(extras[:, p.TORQUE]),
        line_power_w=frozen_array(extras[:, p.LINE_POWER] + course.data.auxiliary_power_w),
        energy_by_input_power_j=frozen_array(states[:, p.INPUT]),
        energy_by_parts_j=frozen_array(by_parts),
        magnetising_so_far_j=frozen_array(states[:, p.MAGNETISING]),
        parts_j={
            "shaft": float(states[-1, p.SHAFT]),
            "stator_copper": float(states[-1, p.STATOR]),
            "rotor_copper": float(states[-1, p.ROTOR]),
            "magnetising": float(states[-1, p.MAGNETISING]),
            "iron": float(states[-1, p.IRON]),
            "stored": float(stored[-1]),
        },
        max_tracking_error_m=float(max(peaks[p.MAX_LAG], -peaks[p.MIN_LAG])),
        final_error_m=float(states[-1, p.X] - planned.position_m[-1]),
        max_current_a=float(peaks[p.MAX_CURRENT]),
        max_torque_current_a=float(peaks[p.MAX_TORQUE_CURRENT]),
        min_torque_current_a=float(peaks[p.MIN_TORQUE_CURRENT]),
        max_phase_voltage_v=float(peaks[p.MAX_VOLTAGE]),
        delay_s=record.delay_s,
        saturated=saturated,
        notes=(
            *_notes(scenario, machines, flux, record, saturated, float(planned.position_m[-1])),
            *([ACCOUNTS_APART.format(100 * apart)] if apart > ALLOWED_DIFFERENCE else []),
        ),
    )


def _stored_j(machines: TractionMachines, states: FloatArray) -> FloatArray:
    """Return what the fields of all machines hold more than at the start [J]."""
    circuit = machines.circuit
    current2 = states[:, p.ID] ** 2 + states[:, p.IQ] ** 2
    flux2 = states[:, p.PSI_D] ** 2 + states[:, p.PSI_Q] ** 2
    held = circuit.leakage_inductance_h * current2 + flux2 / circuit.magnetising_inductance_h
    stored: FloatArray = 0.75 * machines.motors * (held - held[0])
    return stored


def _saturations(record: _Record, error_m: FloatArray) -> tuple[Saturation, ...]:
    spans: list[Saturation] = []
    for what, column in (("current", p.CURRENT_HELD), ("voltage", p.VOLTAGE_HELD)):
        for first, last in _stretches(record.time_s, record.extras[:, column] > 0):
            # a flag tells of the steps since the sample before
            start, end = float(record.time_s[max(first - 1, 0)]), float(record.time_s[last])
            lag = float(np.max(error_m[first : last + 1]))
            if end - start >= SHORT_S or lag >= NOTICEABLE_LAG_M:
                spans.append(Saturation(start, end, what, lag))  # type: ignore[arg-type]
    return tuple(sorted(spans))


def _stretches(time_s: FloatArray, held: BoolArray) -> list[tuple[int, int]]:
    """Return first and last samples of stretches in which a limit is at work, short gaps bridged."""
    at = np.flatnonzero(held)
    if not len(at):
        return []
    apart = np.flatnonzero(np.diff(time_s[at]) > GAP_S)
    return list(zip(at[np.append(0, apart + 1)].tolist(), at[np.append(apart, len(at) - 1)].tolist(), strict=True))


def _notes(
    scenario: Scenario,
    machines: TractionMachines,
    flux: FluxPlan,
    record: _Record,
    saturated: tuple[Saturation, ...],
    end_m: float,
) -> tuple[str, ...]:
    notes = ["The machines are magnetised before the departure; the account begins with it."]
    if scenario.vehicle.braking.friction_effort_kn > 0:
        notes.append("The machines do all the braking: friction brakes are not part of the loop.")
    machine = machines.machine
    if flux.weakest_share < WEAKENED_SHARE:
        notes.append(
            f"The limit of {machine.max_phase_voltage_v:.0f} V per phase weakens the flux to "
            f"{100 * flux.weakest_share:.0f} % of its rated value."
        )
    limits = {
        "current": f"{machines.driving_current_a:g} A driving or {machines.braking_current_a:g} A braking",
        "voltage": f"{machine.max_phase_voltage_v:.0f} V per phase",
    }
    for span in saturated:
        if abs(span.lag_m) < NOTICEABLE_LAG_M:
            continue
        behind = "behind" if span.lag_m > 0 else "ahead of"
        place = float(np.interp(span.start_s, record.time_s, record.states[:, p.X]))
        notes.append(
            f"From {place:.0f} m, {span.start_s:.1f} s to {span.end_s:.1f} s, the {span.what} limit of "
            f"{limits[span.what]} holds the machines back; the train is up to {abs(span.lag_m):.2f} m {behind} "
            "the plan."
        )
    current, largest = float(record.peaks[p.MAX_CURRENT]), max(machines.driving_current_a, machines.braking_current_a)
    if current > OVERSHOOT * largest:
        notes.append(
            f"The current reaches {current:.0f} A, above the limit of {largest:g} A, where the voltage limit or "
            "the speed noise prevents its control."
        )
    beyond = float(record.states[-1, p.X]) - end_m
    if beyond > ARRIVAL_M:
        notes.append(f"The train overshoots its end by {beyond:.1f} m: its machines do not brake as planned.")
    factor = scenario.simulation.rotor_resistance_factor
    if factor != 1:
        notes.append(f"The controller assumes {factor:g} times the true rotor resistance, so its flux axis is wrong.")
    return tuple(notes)


def _trajectory(
    real: Scenario,
    planned: Trajectory,
    course: Course,
    machines: TractionMachines,
    record: _Record,
    stored_j: float,
) -> Trajectory:
    """Return the run as a trajectory; its cells lie between the samples."""
    states, data, motors = record.states, course.data, machines
    time = record.time_s - record.time_s[0]
    place = np.maximum.accumulate(states[:, p.X])
    speed = np.maximum(states[:, p.V], 0.0)
    middle, duration = 0.5 * (place[1:] + place[:-1]), np.diff(time)
    mean_speed = np.maximum(np.diff(place) / duration, SLOWEST_MS)
    moving = np.clip(states[:, p.V] / p.CREEP_MS, -1, 1)
    torque = record.extras[:, p.TORQUE] - motors.machine.mechanical_loss_torque_nm * moving
    gear = np.where(torque > 0, motors.gear_efficiency, 1 / motors.gear_efficiency)
    force = motors.motors * motors.turns_per_metre * torque * gear
    effort = 0.5 * (force[1:] + force[:-1])
    returned = -line_power(-states[:, p.RETURNED], data.recuperation_factor)
    line = states[:, p.DRAWN] - returned + data.auxiliary_power_w * time
    cell = np.clip(np.searchsorted(course.position_m, middle, side="right") - 1, 0, course.cell_count - 1)
    ends = states[-1]
    energy = Energy(
        traction_j=float(ends[p.DRAWN]),
        recuperated_j=float(returned[-1]),
        auxiliary_j=data.auxiliary_power_w * float(time[-1]),
        running_resistance_j=float(ends[p.RUNNING]),
        curve_resistance_j=float(ends[p.CURVE]),
        losses_j={
            "copper": float(ends[p.STATOR] + ends[p.ROTOR]),
            "magnetising": float(ends[p.MAGNETISING]),
            "iron": float(ends[p.IRON]),
            "mechanical": float(ends[p.MECHANICAL]),
            "gear": float(ends[p.GEAR]),
            "magnetic_field": stored_j,
            "brake_resistors": float(resistor_power(-ends[p.RETURNED], data.recuperation_factor)),
        },
        kinetic_j=float(data.half_inertia_kg * (states[-1, p.V] ** 2 - states[0, p.V] ** 2)),
        potential_j=float(ends[p.CLIMB]),
    )
    power_w = np.diff(line) / duration
    return Trajectory(
        scenario=real,
        strategy=planned.strategy,
        position_m=frozen_array(place),
        speed_ms=frozen_array(speed),
        time_s=frozen_array(time),
        line_energy_j=frozen_array(line),
        tractive_effort_n=frozen_array(np.maximum(effort, 0.0)),
        electric_braking_n=frozen_array(np.maximum(-effort, 0.0)),
        friction_braking_n=frozen_array(np.zeros_like(effort)),
        largest_effort_n=frozen_array(data.traction.effort_n(mean_speed)),
        largest_braking_n=frozen_array(data.braking.effort_n(mean_speed) + data.friction_effort_n),
        line_power_w=frozen_array(power_w),
        current_a=frozen_array(0.5 * (states[1:, p.IQ] + states[:-1, p.IQ])),
        gradient_permille=frozen_array(course.gradient_permille[cell]),
        energy=energy,
        line_current_a=line_current_a(power_w, real.vehicle.line_voltage_v),
    )
