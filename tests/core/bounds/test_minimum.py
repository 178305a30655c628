"""The optimum of a decision what the drive does in each cell."""

import numpy as np
import pytest
from every_drive import FRICTIONS_KN, train

from railjoule.core.bounds import minimise, minimise_decided
from railjoule.core.bounds.minimum import SPARED_SHARE
from railjoule.core.interior_point.duty import coasting_exactly, duty, safest_modes
from railjoule.core.interior_point.solver import CONVERGED
from railjoule.core.motion import running_time
from railjoule.core.physics.energy_balance import reference_energy, run_energy
from railjoule.core.physics.mesh_data import BRAKE, OFF
from railjoule.core.strategies import prepare_task, run_strategy

JUMPING = ("loss polynomial", "efficiency map", "induction", "induction with a standstill brake", "synchronous")


def decided(drive, friction_kn=15.0, factor=0.37):
    """Return a task and the optimum that may drive and brake wherever free switching does, which it is not told."""
    task = prepare_task(train(drive, friction_kn, factor, **{"timetable.travel_time_s": 150.0}))
    modes = safest_modes(duty(task.mesh.data, minimise(task).optimum))
    return task, minimise_decided(task, modes)


@pytest.mark.parametrize("friction_kn", FRICTIONS_KN)
@pytest.mark.parametrize("drive", JUMPING)
def test_a_decided_optimum_is_counted_as_its_run_is(drive, friction_kn):
    """Braking too: its hull, free switching, lay up to a fifth of the energy below what the run takes."""
    task, optimum = decided(drive, friction_kn)
    data, speed2 = task.mesh.data, coasting_exactly(task.mesh.data, optimum)
    counted = run_energy(data, speed2) + data.auxiliary_power_w * running_time(data.cell_length_m, speed2)
    assert optimum.status == CONVERGED
    assert counted == pytest.approx(optimum.energy_j, rel=2e-4)


def test_a_drive_that_is_off_generates_nothing():
    """With the friction brakes alone nothing comes back, and more is taken than with the electric brake."""
    task, with_brake = decided("synchronous", 120.0, factor=1.0)
    modes = safest_modes(duty(task.mesh.data, with_brake))
    found = minimise_decided(task, np.where(modes == BRAKE, OFF, modes))
    braked = (modes == BRAKE) & (task.mesh.net_force_n(found.speed2) < -1e3)
    assert braked.sum() > 5
    assert found.braking_n[braked].max() < 1e-2 * task.mesh.data.braking.constant_n
    assert found.energy_j > with_brake.energy_j * 1.01


# On hills, from close to the shortest time, some 107 s, to far beyond it, with and without friction brakes
RELAXED = [
    (drive, friction_kn, time_s)
    for drive in JUMPING
    for friction_kn in (0.0, 120.0)
    for time_s in (112.0, 150.0, 260.0)
]


@pytest.mark.parametrize(("drive", "friction_kn", "time_s"), RELAXED)
def test_a_relaxation_converges_and_no_run_lies_below_it(drive, friction_kn, time_s):
    """Over the same mesh; to a millionth, as a relaxation converges."""
    task = prepare_task(train(drive, friction_kn, 0.37, **{"timetable.travel_time_s": time_s, "solver.mesh_m": 20.0}))
    found = minimise(task)
    assert found.optimum.status == CONVERGED
    for run in (run_strategy(task, "optimal"), run_strategy(task, "bellman")):
        reference = reference_energy(task.mesh.data, run.energy.net_j, task.running_time_s)
        assert run.energy.net_j - found.energy_j >= -1e-6 * reference


def test_some_of_each_limit_is_spared():
    """For what coasting exactly adds: half of what is spared is left by the barrier at the least."""
    task, found = decided("synchronous")
    data, left = task.mesh.data, 1 - 0.5 * SPARED_SHARE
    assert running_time(data.cell_length_m, found.speed2) < task.running_time_s * left
    assert np.all(found.traction_n < data.traction.constant_n * left)
    assert np.all(found.speed2[1:-1] < data.limit_speed2[1:-1] * left)
