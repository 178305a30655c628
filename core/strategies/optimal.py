"""The energy-optimal run, with a proof of how far it can be from the best.

References: the method is in `railjoule.core.interior_point.solver`, the proof in `railjoule.core.bounds`.
"""

import math
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

from railjoule.core.bounds import Solution, bounded, certify, minimise
from railjoule.core.continuous_bound.refinement import cut_low_accounts, refined_optimum
from railjoule.core.errors import RailjouleError, SolverError, StrategyRefusedError
from railjoule.core.lower_bound import LATE_SHARE, Reference, Window
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.passes import slowed_to_reach
from railjoule.core.physics.between_nodes import RunBetweenNodes, follow_between_nodes
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.physics.stretches import shortest_stretch_s
from railjoule.core.strategies.arrival_windows import (
    arrival_windows,
    binding_windows,
    bound_within,
    missed_windows,
    optimum_within,
)
from railjoule.core.strategies.bellman import bellman
from railjoule.core.strategies.line_parts import joined
from railjoule.core.strategies.phases import phases
from railjoule.core.strategies.switching import DecidedRun, best_switched
from railjoule.core.strategy import STRATEGIES, Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

MAX_CUTS = 2
"""How often a mesh is cut for a drive with idle losses where its run needs less than any driving does."""
SAID_SHARE = 1e-4
"""To which the saving of free switching is rounded up, as a share of the energy."""
# Of 1,590 random scenarios 42 had an optimum that another strategy's run undercut by over 0.1 %, all on meshes of fewer
# cells: local optima, or a mesh too coarse to switch a drive on, where `phases` lays out nodes of its own. There both
# runs take some 50 ms, on longer meshes they take longer than the optimum
FEW_CELLS = 100
"""Up to this number of cells an optimum that is not proven is compared with the runs of `bellman` and `phases`."""
SPARED_SHARE = 2e-6
"""Share of the running time that is left for speeds that are lowered afterwards."""
UNPROVEN, CHEAPER = 5e-4, 1e-4
"""The gap from which on an optimum is compared, and by how much a run that replaces it needs less, as shares."""


def optimal(task: Task) -> Trajectory:
    """Return the run that needs the least energy, with its bound; it takes every drive.

    For drives with idle losses, this is the best run found that switches only at nodes and keeps
    `drive.least_switching_s`. Its bound and the saving in its notes are those of runs with free switching. The runs
    near that of `bellman` are compared only where no other lies within 0.5 % of free switching.

    On a mesh of few cells, an optimum that is not proven gives way to a run of `bellman` or `phases` that needs less.
    If the interior point does not converge, it is the best run of dynamic programming, without a bound, with a note.

    Windows of arrival are kept, if need be by waiting at the stop before. If one binds, the bound is that of runs
    that keep them all.

    Parameters
    ----------
    task : Task
        The task.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    SolverError, StrategyRefusedError
        As `railjoule.core.bounds.minimise`, if dynamic programming finds no run either.
    ScenarioError
        If a window of arrival cannot be kept.
    """
    task.require_timetable()
    windows = arrival_windows(task)
    if not windows:
        return unwindowed_optimum(task)
    line = optimum_within(task, windows, unwindowed_optimum)
    binding = binding_windows(task, line, windows)
    if not binding:
        refined = unwindowed_optimum(task)
        if not missed_windows(task, refined):
            return refined
    return _as_reference(task, joined(task, line, bound_within(task, line, windows)), binding)


def unwindowed_optimum(task: Task) -> Trajectory:
    """Return the optimum of a task whatever its windows of arrival; other errors as `optimal`."""
    try:
        return _undercut(task, _by_interior_point(task))
    except SolverError as failure:
        return _by_recursion(task, failure)


def known_optimum(task: Task) -> Trajectory | None:
    """Return the optimum of a task, to measure other runs against; None where it is not found."""
    try:
        return _undercut(task, _by_interior_point(task))
    except RailjouleError:
        # the reference is optional
        return None


def _by_interior_point(task: Task) -> Trajectory:
    """Return the optimum with its bound; errors as `railjoule.core.bounds.minimise`."""
    if not task.mesh.drive.has_idle_losses:
        return _smooth_optimum(task)
    best = _switched_optimum(task)
    for _ in range(MAX_CUTS if task.can_be_remeshed else 0):
        if not best.is_below_bound:
            break
        task = cut_low_accounts(task, best)
        try:
            task.require_timetable()
            best = _switched_optimum(task)
        except RailjouleError:
            # what the coarse mesh allows is the best known; its notes say that it is too coarse
            break
    return best


def _switched_optimum(task: Task) -> Trajectory:
    """Return the best run found of a drive with idle losses over the task's mesh, with its bound."""
    # the bound belongs to this optimum, which is relaxed: the run below may be another, and lie above it
    solution = minimise(task)
    run = best_switched(task, solution.optimum)
    best = make_trajectory(
        task.scenario,
        task.mesh,
        "optimal",
        run.speed2,
        bound=certify(task, solution.optimum),
        price_of_time_w=run.price_of_time_w,
        iterations=run.iterations,
        notes=(switching_note(task, solution, run),),
    )
    return _as_reference(task, best)


def _smooth_optimum(task: Task) -> Trajectory:
    """Return the optimum of a drive without idle losses, over a mesh that is refined where the task allows it."""
    time_s, lowers = task.running_time_s, _has_corners(task)
    if lowers:
        # the lowered speeds take longer by about as much
        slack_s = max(time_s - task.shortest_time_s, 0.0)
        task = replace(task, running_time_s=time_s - min(SPARED_SHARE * time_s, 0.01 * slack_s))
    if task.can_be_remeshed:
        found = refined_optimum(task)
        task, solution, proven = found.task, found.solution, found.bound
    else:
        solution, proven = minimise(task), None
    speed2 = solution.optimum.speed2
    if lowers:
        # the bound is that of the whole time
        task, proven = replace(task, running_time_s=time_s), None
        speed2 = slowed_to_reach(task.mesh.data, speed2)
    # a mesh that is given stays as it is, whatever lies between its nodes
    notes = excess_notes(follow_between_nodes(task.mesh.data, speed2)) if task.can_be_remeshed else ()
    best = make_trajectory(
        task.scenario,
        task.mesh,
        "optimal",
        speed2,
        bound=certify(task, solution.optimum, proven),
        price_of_time_w=solution.optimum.price_of_time_w,
        iterations=solution.iterations,
        notes=notes,
    )
    return _as_reference(task, best)


def excess_notes(followed: RunBetweenNodes) -> tuple[str, ...]:
    """Return a sentence on the limit that a run exceeds between two nodes; none where the train can drive it."""
    if followed.is_possible:
        return ()
    excess, limit = followed.max_excess, {"traction": "largest traction", "braking": "largest braking effort"}
    return (
        f"Between two nodes of the mesh, from {excess.start_m:.0f} m on, the run needs {100 * excess.share:.2g} % more "
        f"than the {limit.get(excess.kind, 'speed limit')}. With a smaller solver.mesh_m it does not, or the timetable "
        "is too short.",
    )


def _has_corners(task: Task) -> bool:
    """Return whether the efforts of an optimum may exceed their limits by more than its last digits.

    They may by up to a per cent, a ten-thousandth of a metre per second, at the corner of a starting resistance or the
    ramp of a step: the speeds are then lowered until the limits are kept.
    """
    vehicle = task.scenario.vehicle
    curves = (vehicle.traction.curve or (), vehicle.braking.curve or ())
    has_steps = any(one[0] == other[0] for curve in curves for one, other in pairwise(curve))
    return has_steps or task.mesh.data.starting_n > 0


def _undercut(task: Task, best: Trajectory) -> Trajectory:
    """Return an optimum, or the run of another strategy that keeps all it keeps and needs less."""
    is_close = best.gap is not None and best.gap <= UNPROVEN
    if is_close or task.mesh.cell_count > FEW_CELLS or not task.can_be_remeshed:
        return best
    runs = []
    for strategy in (bellman, phases):
        with suppress(RailjouleError):
            runs.append(strategy(task))
    for run in sorted(runs, key=lambda run: run.energy.net_j):
        saving = (best.energy.net_j - run.energy.net_j) / max(abs(best.energy.net_j), 1.0)
        data, speed2 = build_meshed_line(task.scenario, *task.end_speeds_ms, run.nodes_m).data, run.node_speed_ms**2
        is_kept = shortest_stretch_s(data, speed2) >= task.least_switching_s
        if saving > CHEAPER and is_kept and run.travel_time_s <= task.travel_time_s * (1 + LATE_SHARE):
            note = (
                f"This is the run of {STRATEGIES[run.strategy].label}: it needs {100 * saving:.2g} % less than the "
                "best run found by the interior-point method, which is a local optimum or bound to the nodes of a "
                "coarse mesh (solver.mesh_m)."
            )
            notes = (note, *excess_notes(follow_between_nodes(data, speed2)), *run.notes)
            named = bounded(task, replace(run, strategy="optimal", notes=notes), best.bound)
            # a run below its bound needs less only by the account of a mesh that is too coarse
            if not named.is_below_bound:
                return _as_reference(task, named)
    return best


def _as_reference(task: Task, best: Trajectory, windows: tuple[Window, ...] = ()) -> Trajectory:
    """Return a run that others of its task are measured against, if they keep the windows that bind it."""
    reference = Reference(best.energy.net_j, best.strategy, task.travel_time_s, best.is_proven, windows)
    return replace(best, reference=reference)


def _by_recursion(task: Task, failure: SolverError) -> Trajectory:
    """Return the best run of dynamic programming, or raise the failure of the interior point."""
    try:
        run = bellman(task)
    except (SolverError, StrategyRefusedError):
        raise failure from None
    note = f"The interior-point method failed: {failure} This is the best run of dynamic programming, without a bound."
    return _as_reference(task, replace(run, strategy="optimal", notes=(note, *run.notes)))


def switching_note(task: Task, relaxed: Solution, run: DecidedRun) -> str:
    """Return in one sentence what an optimal run is, and what free switching could save at most."""
    friction = (
        "friction brakes take over where electric braking would draw power"
        if task.mesh.data.friction_effort_n > 0
        else "the vehicle has no friction brakes to support the electric ones"
    )
    parts = [f"{_kept_words(task, run)}; this is the best such run found, not proven"]
    energy_j, optimum = run.energy_j + task.dwell_energy_j, relaxed.optimum
    # what free switching needs at least, as far as the relaxed optimum is the best of its problem
    gap_j = optimum.relative_gap * reference_energy(task.mesh.data, optimum.energy_j, task.running_time_s)
    saving = 1 - (relaxed.energy_j - gap_j) / energy_j if energy_j > 0 else -1.0
    # a relaxed energy above the run's is not the best of its problem
    if saving >= 0:
        percent = math.ceil(saving / SAID_SHARE) * SAID_SHARE * 100
        parts.append(f"switching freely within the cells of this mesh would save at most about {percent:.2f} %")
    return "; ".join([*parts, friction]) + "."


def _kept_words(task: Task, run: DecidedRun) -> str:
    """Return the words for how often a run's drive is switched."""
    least, shortest = task.least_switching_s, shortest_stretch_s(task.mesh.data, run.speed2)
    if least == 0.0:
        return "Each cell is driven, braked or coasted as a whole"
    if shortest < least:
        return (
            f"No run was found whose drive stays on or off for the minimum on/off time of {least:g} s: this one is "
            f"switched after {shortest:.1f} s"
        )
    return f"The drive stays on or off for at least {least:g} s, to the nearest cell, but between driving and braking"


register(
    Strategy(
        name="optimal",
        run=optimal,
        order=10,
        label="Optimal",
        colour=("#0B5BD3", "#7AA2FF"),
        dash="solid",
        help=(
            "The run that needs the least energy in the given time, found by an interior-point method. A lower "
            "bound, computed separately, shows how far it can be from the true optimum."
        ),
        applies_to="every scenario",
        labels=("Optimum",),
        is_light=True,
    )
)
