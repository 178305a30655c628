"""The sweep of energies: what it finds in energies that are known, and a thin one of the drives that have no jump."""

from dataclasses import replace

import numpy as np
import pytest

from tests import sweep_energy
from tests.any_scenarios import MODELS
from tests.builders import plain_scenario
from tests.sweep_energy import Case, cases, roughness, row, swept, task_at

SAME = 1e-6
"""Each of two optima is within 1e-7 of the best; the rest is for rounding and what limits may be violated by."""
LARGEST_JUMP = 1e-5
"""Far below what the product claims, 1e-4: the full sweep finds 1e-6, of which most is the slope that is left."""
LARGEST_STEP = 1e-4
"""What the product claims of the drives that take power without effort, whose runs are the best found."""
SMOOTH = [case for case in cases(("constant_efficiency", "copper_loss")) if case.name != "metro-10-stations"]
JUMPING = [case for case in cases(MODELS[2:]) if case.name.startswith("hills")]
THIN = {"time": 50, "load": 12, "gradient": 12}


@pytest.mark.parametrize("over", THIN)
@pytest.mark.parametrize("case", SMOOTH, ids=lambda case: case.name)
def test_energies_have_a_sense_and_no_jump(case, over):
    sweep = swept(case, over, THIN[over])
    assert len(sweep.values) == THIN[over]
    assert not sweep.refusals
    assert not sweep.unbounded
    assert not sweep.wide
    assert sweep.against <= SAME
    assert sweep.jump <= LARGEST_JUMP


@pytest.mark.parametrize("over", ["load", "gradient"])
@pytest.mark.parametrize("case", JUMPING, ids=lambda case: case.name)
def test_more_load_or_gradient_never_costs_less(case, over, monkeypatch):
    monkeypatch.setattr(sweep_energy, "ROUGH", np.inf)  # where to drive changes from cell to cell: these energies jump
    sweep = swept(case, over, THIN[over])
    assert len(sweep.values) == THIN[over]
    assert not sweep.unbounded
    assert sweep.sense == 1
    assert sweep.against <= LARGEST_STEP


def test_what_has_a_sense():
    flat, falling = ({"line.sections": [{"length_m": 900.0, "gradient_permille": g}]} for g in (0.0, -1.0))
    senses = [
        swept(Case("", plain_scenario({**line, "solver.mesh_m": 50.0})), over, 2).sense
        for line in (flat, falling)
        for over in ("time", "load", "gradient")
    ]
    assert senses == [-1, 1, 1, -1, 0, 1]


def energies(function, values):
    """Return a sweep over time of energies near 1."""
    empty = swept(Case("", plain_scenario({"solver.mesh_m": 50.0})), "time", 0)
    energy = np.array([function(value) for value in values])
    return replace(empty, values=np.array(values), energy_j=energy, reference_j=np.ones(len(values)))


def test_small_steps_against_the_sense_add_up():
    sweep = energies(lambda value: 1 + 1e-5 * max(value - 5, 0), range(10))
    assert sweep.against == pytest.approx(4e-5)
    assert replace(sweep, sense=1).against == 0
    assert replace(sweep, sense=0).against == 0


@pytest.mark.parametrize(("what", "share"), [(lambda x: 1e-3 * (x > 5.5), 0.5), (lambda x: 1e-3 * (x == 5), 1.0)])
def test_half_of_a_jump_and_all_of_an_outlier_shows(what, share):
    values = [0.0, 1, 2, 2.5, 3, 4, 5, 6, 7, 8, 9]
    cubic = energies(lambda x: 1 - 0.02 * x + 0.003 * x**2 - 0.0001 * x**3, values)
    assert cubic.roughness < 1e-14
    rough = energies(lambda x: 1 - 0.02 * x + 0.003 * x**2 - 0.0001 * x**3 + what(x), values)
    assert rough.roughness == pytest.approx(1e-3 * share, rel=0.2)


@pytest.mark.parametrize("jump", [3e-4, -3e-4, 0.0])
def test_a_jump_stays_where_a_kink_vanishes(monkeypatch, jump):
    """At 1.611 the slope halves, and the energy jumps or does not."""

    def energy(value):
        return 1 - 0.2 * value + (0.1 * (value - 1.611) + jump) * (value > 1.611)

    monkeypatch.setattr(sweep_energy, "energy_at", lambda scenario, over, value, time_s: energy(value))
    values = np.linspace(1.5, 1.7, 11)
    off = roughness(values, np.array([energy(value) for value in values]), np.ones(11))
    (place,) = np.flatnonzero(off == off.max()) + 2
    around = values[place - 2 : place + 3]
    energies_j = np.array([energy(value) for value in around])
    found, at = sweep_energy._jump(plain_scenario(), "time", 0.0, around, energies_j, 1.0)
    assert found == pytest.approx(abs(jump), rel=0.3, abs=2e-6)
    assert at == pytest.approx(1.611, abs=1e-4)


@pytest.mark.parametrize("reverse", [False, True])
def test_the_middle_third_is_inclined_in_running_order(reverse):
    sections = [{"length_m": 400.0, "gradient_permille": 1.0}, {"length_m": 500.0, "gradient_permille": 2.0}]
    course = task_at(plain_scenario({"line.sections": sections, "line.reverse": reverse}), "gradient", 7.0).course
    middle = 0.5 * (course.position_m[1:] + course.position_m[:-1])
    ends = (-2.0, -1.0) if reverse else (1.0, 2.0)
    assert np.all(course.gradient_permille[middle < 300] == ends[0])
    assert np.all(course.gradient_permille[(middle > 300) & (middle < 600)] == 7)
    assert np.all(course.gradient_permille[middle > 600] == ends[1])


def test_refusals_are_counted_with_their_words():
    # on 20 per mille its 100 t need 20 kN
    weak = plain_scenario({"vehicle.traction.max_effort_kn": 10.0, "solver.mesh_m": 50.0})
    sweep = swept(Case("weak", weak), "gradient", 9)
    assert 0 < len(sweep.refusals) < 9
    assert len(sweep.values) == 9 - len(sweep.refusals)
    assert "comes to a stand" in sweep.refusals[-1]
    assert row(sweep).startswith(f"| constant_efficiency | weak | gradient | {len(sweep.values)} | ")
