"""The least energy of every drive over time, load and gradient: its sense, and where it must not jump.

- Over the travel time it never rises. A run may arrive early, and its auxiliaries count until it arrives, so that every
  run of a shorter timetable is one of a longer timetable as well, at the same energy.
- Over the gradient of a part of the line, at the same time, it never falls: the same speeds need more net force there.
- Over the load, at the same time, it never falls where the line ends no lower than it begins. Of a heavier train's
  efforts f and b at some speeds, of its drag D and of a ratio q < 1 of masses, a lighter train takes q f + (1 - q) D
  and q b for the same speeds. Losses that are convex in the effort make of an energy E no more than q E + (1 - q) times
  what the drag alone takes, and that is no more than E where nothing is gained from height.
- Over each of the three it is continuous, unless the drive has idle losses. Its slope is not: where a train holds a
  speed limit, or just needs no effort to arrive at one, the marginal energy of time and force jumps.

A sweep is measured by two shares of the energy. One is how far an energy passes any earlier one against the sense, so
that small steps add up. The other is the largest jump: wherever an energy is off the cubic through two neighbours on
either side, which half of a jump is, the place is sampled more finely. A kink vanishes; a jump stays.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.optimal import unwindowed_optimum
from tests.every_drive import train
from tests.proven_trains import IDLING, SMOOTH

RANGES = {"time": (1.02, 2.0, 50), "load": (0.0, 1.0, 12), "gradient": (-20.0, 20.0, 12)}
"""Each sweep: share of the shortest time, load factor, gradient of the line's middle third [per mille]; points."""
TIME_SHARE = 1.2
"""Of the shortest time of the slowest train, the time that trains of all loads and gradients have."""
SAME = 1e-6
"""Each of two optima is within 1e-7 of the best; the rest is for rounding and what limits may be violated by."""
LARGEST_JUMP = 1e-5
"""Far below what the product claims, 1e-4."""
LARGEST_STEP = 1e-4
"""What the product claims of drives with idle losses, whose runs are the best found."""
ROUGH = 3e-5
"""Beyond this share off the cubic a place is searched for a jump; half of a jump shows, so that the least is twice."""
ZOOMS, NO_JUMP = 6, 1e-6
"""Times that such a place is sampled four times more finely; what is less than this share is rounding."""
SHIPPED = ("liashenko-iii", "metro-with-limit", "ftorek-300s", "liashenko-0", "liashenko-ii")
"""Those whose drive has no idle losses; the last two, which have the train of the first, are swept by night."""
NIGHTLY = SHIPPED[3:]


def hills(drive, mesh_m=10.0):
    """Return a metro car over hills; in reverse they end higher than they begin."""
    return train(drive, friction_kn=15.0, **{"line.reverse": True, "solver.mesh_m": mesh_m})


def task_at(scenario, over, value, running_time_s=0.0):
    """Return the task, over one mesh, of a scenario at a value of a quantity; with a running time unless that is it."""
    if over == "load":
        scenario = scenario.replace(**{"vehicle.load_factor": value})
    elif over == "gradient":
        scenario = scenario.replace(**{"line.sections": inclined(scenario, value)})
    task = prepare_task(scenario)
    running_time_s = value * task.shortest_time_s if over == "time" else running_time_s
    return replace(task, running_time_s=running_time_s, can_be_remeshed=False)


def inclined(scenario, gradient_permille):
    """Return the sections of a line with another gradient in running order over its middle third."""
    gradient = -gradient_permille if scenario.line.reverse else gradient_permille
    ends = np.cumsum([0.0, *(section.length_m for section in scenario.line.sections)]).tolist()
    first, last = ends[-1] / 3, 2 * ends[-1] / 3
    sections = []
    for section, (start, end) in zip(scenario.line.sections, pairwise(ends), strict=True):
        for begin, stop in pairwise([start, *(place for place in (first, last) if start < place < end), end]):
            part = section.model_dump(exclude_none=True) | {"length_m": stop - begin}
            if first < 0.5 * (begin + stop) < last:
                part["gradient_permille"] = gradient
            sections.append(part)
    return sections


def swept(scenario, over):
    """Return values, tasks and optima over a quantity, all in one time unless that is the quantity.

    They are over the mesh of the scenario: where it is refined, energies move by up to the tolerance.
    """
    values = np.linspace(*RANGES[over])
    tasks = [task_at(scenario, over, value) for value in values.tolist()]
    if over != "time":
        longest = TIME_SHARE * max(task.shortest_time_s for task in tasks)
        tasks = [replace(task, running_time_s=longest) for task in tasks]
    return values, tasks, [unwindowed_optimum(task) for task in tasks]


def references(tasks, energy_j):
    """Return what shares of energies are relative to [J]."""
    pairs = zip(tasks, energy_j, strict=True)
    return np.array([reference_energy(task.mesh.data, energy, task.running_time_s) for task, energy in pairs])


def against(over, tasks, energy_j, reference_j):
    """Return the largest share by which an energy passes any earlier one against the sense, 0 without a sense."""
    if over == "load" and any(task.mesh.gradient_force_n @ task.mesh.data.cell_length_m < 0 for task in tasks):
        return 0.0
    rising = -energy_j if over == "time" else energy_j
    return ((np.maximum.accumulate(rising) - rising) / reference_j).max()


def roughness(values, energy_j):
    """Return how far each energy but the outer two is off the cubic through its neighbours."""
    middle = np.arange(2, len(values) - 2)
    neighbours = middle[:, None] + np.array([-2, -1, 1, 2])
    x = values[neighbours] - values[middle, None]
    # Lagrange's weights at 0
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
    weights = np.prod(x[:, others] / (x[:, others] - x[:, :, None]), axis=2)
    return np.abs((weights * energy_j[neighbours]).sum(axis=1) - energy_j[middle])


def largest_jump(values, shares, share_at):
    """Return the largest jump of shares of energies; `share_at` gives that of another value."""
    off = np.pad(roughness(values, shares), 2)
    rough = [i for i in range(2, len(off) - 2) if off[i] > ROUGH and off[i] >= off[i - 1 : i + 2].max()]
    return max((zoomed_jump(values[i - 2 : i + 3], shares[i - 2 : i + 3], share_at) for i in rough), default=0.0)


def zoomed_jump(values, shares, share_at):
    """Return by how much the shares jump between the second and the fourth of five values."""
    for _ in range(ZOOMS):
        inner = np.linspace(values[1], values[3], 9)
        x = np.concatenate([values[:1], inner, values[4:]])
        share = np.concatenate([shares[:2], [share_at(value) for value in inner[1:-1].tolist()], shares[3:]])
        off = roughness(x, share)
        worst, jump = int(off.argmax()), 2 * off.max()
        values, shares = x[worst : worst + 5], share[worst : worst + 5]
        if jump < NO_JUMP:
            break
    return jump


@pytest.mark.parametrize("over", RANGES)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.nightly][: name in NIGHTLY]) for name in (*SHIPPED, *SMOOTH)]
)
def test_energies_have_a_sense_and_no_jump(name, over):
    scenario = load_scenario(name) if name in SHIPPED else hills(name)
    values, tasks, runs = swept(scenario, over)
    energy = np.array([run.energy.net_j for run in runs])
    reference = references(tasks, energy)
    assert against(over, tasks, energy, reference) <= SAME

    def share_at(value):
        task = task_at(scenario, over, value, tasks[0].running_time_s)
        return unwindowed_optimum(task).energy.net_j / reference.mean()

    assert largest_jump(values, energy / reference.mean(), share_at) <= LARGEST_JUMP


@pytest.mark.parametrize("over", ["load", "gradient"])
@pytest.mark.parametrize("drive", IDLING)
def test_more_load_or_gradient_never_costs_less(drive, over):
    """Where to drive changes from cell to cell: these energies jump."""
    _, tasks, runs = swept(hills(drive, mesh_m=20.0), over)
    assert all(run.bound is not None for run in runs)
    energy = np.array([run.energy.net_j for run in runs])
    assert against(over, tasks, energy, references(tasks, energy)) <= LARGEST_STEP


@pytest.mark.parametrize("jump", [3e-4, -3e-4, 0.0])
def test_a_jump_stays_where_a_kink_vanishes(jump):
    """At 1.611 the slope halves, and the energy jumps or does not."""

    def share(value):
        return 1 - 0.2 * value + (0.1 * (value - 1.611) + jump) * (value > 1.611)

    values = np.linspace(1.5, 1.7, 11)
    found = largest_jump(values, np.array([share(value) for value in values]), share)
    assert found == pytest.approx(abs(jump), rel=0.3, abs=2e-6)
