"""Our optimum and our proof beside IPOPT, which knows nothing of either."""

import importlib.util

import pytest
from random_scenarios import random_run

from railjoule.core import SolverError, load_scenario
from railjoule.core.bounds import certify, minimise
from railjoule.core.strategies import Task, prepare_task
from railjoule.core.validation import ipopt
from railjoule.core.validation.ipopt import IpoptProblem

needs_casadi = pytest.mark.skipif(
    importlib.util.find_spec("casadi") is None, reason="CasADi is not installed, so there is no IPOPT to compare with"
)
AGREEMENT = 1e-5
"""Bar of the project's first issue; measured on 100: 4e-8 above IPOPT at most, 5e-7 below."""
BOUND_EXCESS = 1e-9
"""IPOPT relaxes no bound here (bound_relax_factor = 0), so only rounding may put our bound above its energy.

Or too coarse a mesh: the bound holds for every driving, and one power in each cell may need less, see the last test.
"""
SMALL_ENERGY_SHARE = 0.1
GATE, SAMPLE = 10, range(40)
"""Random scenarios: the gate takes the first ones, the night all."""

FRICTION = {
    "vehicle.braking.max_effort_kn": 120.0,
    "vehicle.braking.friction_effort_kn": 200.0,
    "drive.recuperation_factor": 0.6,
}
RISE_LIMITS = {"vehicle.traction.max_acceleration_ms2": 0.7, "vehicle.braking.max_deceleration_ms2": 0.6}
CURVE = {"vehicle.traction.curve": [[0, 285], [35, 285], [50, 200], [65, 130], [80, 90]]}
STOP = {
    "line.stations": [{"position_m": 600.0, "dwell_s": 20.0}],
    "vehicle.auxiliary_power_kw": 30.0,
    "timetable.travel_time_s": 190.0,
}
KINKED_COPPER = {"drive.recuperation_factor": 0.3}
NEUTRAL = {"line.neutral_sections": [{"from_m": 20.0, "to_m": 120.0}, {"from_m": 700.0, "to_m": 850.0}]}
COPPER_NEUTRAL = {**KINKED_COPPER, **NEUTRAL, "solver.mesh_m": 5.0}
CASES = {
    "neutral sections": ("liashenko-iii", NEUTRAL),
    "neutral sections and friction brakes": ("liashenko-ii", {**FRICTION, **NEUTRAL}),
    "copper loss with neutral sections": ("ftorek-300s", COPPER_NEUTRAL),
    "friction brakes": ("liashenko-ii", FRICTION),
    "limits of acceleration": ("liashenko-ii", RISE_LIMITS),
    "an effort curve": ("liashenko-ii", CURVE),
    "a stop with auxiliaries": ("liashenko-ii", STOP),
    "everything": ("liashenko-iii", {**FRICTION, **RISE_LIMITS, **CURVE, "solver.mesh_m": 10.0}),
    "copper loss that draws in braking": ("ftorek-300s", KINKED_COPPER),
    "copper loss with friction brakes": ("ftorek-300s", {**KINKED_COPPER, **FRICTION, "solver.mesh_m": 20.0}),
}


def reference_energy_j(task, energy_j):
    """What differences are relative to: the energy, but at least a tenth of the kinetic one at the mean speed."""
    mean = task.mesh.length_m / task.running_time_s
    return max(abs(energy_j), SMALL_ENERGY_SHARE * task.mesh.data.half_inertia_kg * mean**2)


def ours(task):
    solution = minimise(task)
    return solution.energy_j, certify(task, solution.optimum).energy_j


def assert_agreement(task):
    energy, bound = ours(task)
    theirs = IpoptProblem(task).solve()
    scale = reference_energy_j(task, energy)
    assert theirs.converged, theirs.status
    assert energy == pytest.approx(theirs.energy_j, abs=AGREEMENT * scale)
    assert bound <= theirs.energy_j + BOUND_EXCESS * scale


@needs_casadi
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[pytest.mark.nightly][: seed >= GATE]) for seed in SAMPLE])
def test_energies_agree_and_no_bound_lies_above(seed):
    run = random_run(seed, stops=seed % 2 == 1)
    assert_agreement(Task(run.scenario, run.mesh, run.fastest_speed2, run.shortest_time_s, run.running_time_s))


@needs_casadi
@pytest.mark.parametrize("case", CASES)
def test_energies_agree_with(case):
    name, changes = CASES[case]
    assert_agreement(prepare_task(load_scenario(name, changes)))


@needs_casadi
def test_the_textbook_formulation_is_the_same_problem():
    task = prepare_task(load_scenario("liashenko-ii"))
    tuned, textbook = IpoptProblem(task).solve(), IpoptProblem(task, textbook=True).solve()
    assert textbook.converged
    # both stop at a scaled tolerance of 1e-9
    assert textbook.energy_j == pytest.approx(tuned.energy_j, rel=1e-7)
    assert textbook.iterations > tuned.iterations


@needs_casadi
def test_a_problem_is_solved_alike_each_time():
    problem = IpoptProblem(prepare_task(load_scenario("liashenko-0")))
    first, second = problem.solve(), problem.solve()
    assert first.energy_j == second.energy_j
    assert first.speed2.tolist() == second.speed2.tolist()
    assert first.speed2[0] == first.speed2[-1] == 0


def test_without_casadi_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setattr(ipopt, "is_installed", lambda: False)
    with pytest.raises(SolverError, match="pip install casadi"):
        IpoptProblem(prepare_task(load_scenario("liashenko-0")))


@needs_casadi
@pytest.mark.parametrize("mesh_m", [20.0, pytest.param(10.0, marks=pytest.mark.nightly)])
def test_the_bound_of_a_coarse_mesh_lies_below_the_optimum_of_a_fine_one(mesh_m):
    """One power in each cell of 10 m or more needs less here than any driving: its optimum is below its own bound."""
    coarse, fine = (
        prepare_task(load_scenario("ftorek-300s", {**COPPER_NEUTRAL, "solver.mesh_m": length}))
        for length in (mesh_m, 2.5)
    )
    optimum = minimise(coarse)
    energy, bound = optimum.energy_j, certify(coarse, optimum.optimum).energy_j
    theirs = IpoptProblem(fine).solve()
    assert theirs.converged, theirs.status
    assert energy < bound <= theirs.energy_j
    # they close as the mesh is refined
    assert bound == pytest.approx(theirs.energy_j, rel=1e-3)
