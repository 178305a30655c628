"""`python -m tests.sweep_energy` sweeps the least energy of every drive over time, load and gradient, and tables it.

What physics asks of the energy that the optimum takes from the line, auxiliaries included:

- Over the travel time it never rises. A run may arrive early, and its auxiliaries count until it arrives, so that every
  run of a shorter timetable is one of a longer timetable as well, at the same energy.
- Over the gradient of a part of the line, at the same time, it never falls: the same speeds need more net force there.
  Brakes at their limit are an exception, which random scenarios have: a train that must brake there for a stop has to
  run otherwise where it descends more.
- Over the load, at the same time, it never falls where the line ends no lower than it begins. Of a heavier train's
  efforts f and b at some speeds, of its drag D and of a ratio q < 1 of masses, a lighter train takes q f + (1 - q) D
  and q b for the same speeds. Losses that are convex in the effort make of an energy E no more than q E + (1 - q) times
  what the drag alone takes, and that is no more than E where nothing is gained from height.
- Over each of the three it is continuous. Its slope is not: where a train holds a limit of speed, or just needs no
  effort to arrive at one, the price of time and of force jumps.

Each sweep is held to that by two shares of the energy. One is how far an energy passes any earlier one against the
sense, so that small steps add up. The other is the largest jump: wherever an energy is off the cubic through two
neighbours on either side, which half of a jump is, the place is zoomed in. A kink vanishes; a jump stays.

What is proven at a longer time holds at each shorter one: over the travel time, the gaps are those of the strongest
bounds. How far the bounds themselves were against that is in the table, too.

A jump against the sense that is less than what the energy changes from value to value is seen as a jump alone.

Drives that take power as soon as they are on have runs that are the best found, not the best: their energies jump.
"""

import argparse
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from railjoule.core import RailjouleError, Trajectory, load_scenario
from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import strongest_bounds
from railjoule.core.errors import InfeasibleLineError
from railjoule.core.physics.reference import reference_energy
from railjoule.core.scenario import Scenario, scenario_from_document
from railjoule.core.strategies import Task, prepare_task, run_strategy
from tests.any_scenarios import MODELS, any_document
from tests.every_drive import DRIVES, train

RANGES = {"time": (1.02, 2.0), "load": (0.0, 1.0), "gradient": (-20.0, 20.0)}
"""Ends of each sweep: share of the shortest time, load factor, gradient of the line's middle third [per mille]."""
COUNTS = {"time": 300, "load": 60, "gradient": 60}
TIME_SHARE = 1.2
"""Of the shortest time of the slowest train, the time that trains of all loads and gradients have."""
WIDE_GAP = 1e-3
ROUGH = 3e-5
"""Beyond this share off the cubic a place is looked at for a jump; half of a jump shows, so that the least is twice."""
ZOOMS, NO_JUMP = 6, 1e-6
"""How often such a place is zoomed in, four times each; what is less than this share is no jump, but rounding."""
SHIPPED = {
    "constant_efficiency": ("liashenko-0", "liashenko-ii", "liashenko-iii", "metro-with-limit", "metro-10-stations"),
    "copper_loss": ("ftorek-300s",),
    "induction": ("tram-950m", "tram-950m-recuperating"),
    "synchronous": ("kharkiv-like-40kmh",),
}
"""The scenarios of each drive that has some; a metro car with each drive is swept as well."""


@dataclass(frozen=True)
class Case:
    """A scenario to sweep."""

    name: str
    scenario: Scenario


@dataclass(frozen=True, eq=False)
class Sweep:
    """Energies over one quantity.

    Parameters
    ----------
    case : Case
    over : str
        A key of RANGES.
    sense : int
        1 where the energy must not fall, -1 where it must not rise, 0 where it may do either.
    values : array of shape (m,)
        Values of the quantity that have a run.
    energy_j, reference_j : array of shape (m,)
        Energies and what they are compared with [J].
    jump, jump_at : float
        The largest jump as a share of the energy, and where it is.
    refusals : tuple of str
        What was refused, and why.
    unbounded, wide : int
        How many runs have no bound, as they come from dynamic programming; how many are further off than WIDE_GAP.
    bounds_against : float
        Over the travel time, the largest share by which a bound lies below that of a longer time.
    seconds : float
        What it took [s].
    """

    case: Case
    over: str
    sense: int
    values: FloatArray
    energy_j: FloatArray
    reference_j: FloatArray
    jump: float
    jump_at: float
    refusals: tuple[str, ...]
    unbounded: int
    wide: int
    bounds_against: float
    seconds: float

    @property
    def against(self) -> float:
        """The largest share by which an energy passes any earlier one against the sense."""
        rising = self.sense * self.energy_j
        return float(((np.maximum.accumulate(rising) - rising) / self.reference_j).max(initial=0.0))

    @property
    def roughness(self) -> float:
        """The largest share by which an energy is off the cubic through its neighbours."""
        return float(roughness(self.values, self.energy_j, self.reference_j).max(initial=0.0))


# ---- what is swept


def cases(models: Iterable[str] = MODELS) -> Iterator[Case]:
    """Yield the shipped scenarios of each drive, and a metro car with each drive that goes uphill over hills."""
    for model in models:
        for name in SHIPPED.get(model, ()):
            yield Case(name, load_scenario(name))
        for name, drive in DRIVES.items():
            if drive["model"] == model:
                # turned round, the hills end higher than they begin
                yield Case(f"hills, {name}", train(name, friction_kn=15.0, **{"line.reverse": True}))


def random_cases(seeds: Iterable[int], models: Iterable[str] = MODELS) -> Iterator[Case]:
    """Yield random scenarios whose line can be passed."""
    for seed in seeds:
        document = any_document(seed)
        if document["vehicle"]["drive"]["model"] in models:
            scenario = scenario_from_document(document)
            try:
                prepare_task(scenario)
            except InfeasibleLineError:
                continue
            yield Case(f"any {seed}", scenario)


def task_at(scenario: Scenario, over: str, value: float, running_time_s: float = 0.0) -> Task:
    """Return the task of a scenario at a value of a quantity, with a running time unless that is the quantity."""
    if over == "load":
        scenario = scenario.with_(**{"vehicle.load_factor": value})
    elif over == "gradient":
        scenario = scenario.with_(**{"line.sections": _inclined(scenario, value)})
    task = prepare_task(scenario)
    return replace(task, running_time_s=value * task.shortest_time_s if over == "time" else running_time_s)


def _inclined(scenario: Scenario, gradient_permille: float) -> list[dict[str, Any]]:
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


# ---- how it is swept


def swept(case: Case, over: str, count: int) -> Sweep:
    """Return the least energies of a case over a quantity."""
    started = time.perf_counter()
    values, tasks, refusals = _tasks(case.scenario, over, count)
    runs: list[tuple[float, Task, Trajectory]] = []
    for value, task in zip(values, tasks, strict=True):
        try:
            runs.append((value, task, run_strategy(task, "optimal")))
        except RailjouleError as refusal:
            refusals.append(f"{over} {value:.4g}: {refusal}")
    solved = np.array([value for value, _, _ in runs])
    energy = np.array([run.energy.net_j for _, _, run in runs])
    reference = np.array(
        [reference_energy(task.course.data, run.energy.net_j, task.running_time_s) for _, task, run in runs]
    )
    bounded = [run for _, _, run in runs if run.bound is not None]
    proven = [run.bound for run in bounded if run.bound is not None]
    strongest = strongest_bounds(proven) if over == "time" else proven
    weak = [
        (strong.energy_j - own.energy_j) / abs(run.energy.net_j)
        for run, strong, own in zip(bounded, strongest, proven, strict=True)
    ]
    gaps = [run.with_bound(bound).gap for run, bound in zip(bounded, strongest, strict=True)]
    time_s = tasks[0].running_time_s if tasks else 0.0
    jumps = [(0.0, np.nan)]
    for place in _rough_places(solved, energy, reference):
        five = slice(place - 2, place + 3)
        jumps.append(_jump(case.scenario, over, time_s, solved[five], energy[five], reference[place]))
    return Sweep(
        case,
        over,
        _sense(over, tasks),
        solved,
        energy,
        reference,
        *max(jumps, key=lambda jump: jump[0]),
        tuple(refusals),
        len(runs) - len(bounded),
        sum(gap is not None and gap > WIDE_GAP for gap in gaps),
        max(weak, default=0.0),
        time.perf_counter() - started,
    )


def _tasks(scenario: Scenario, over: str, count: int) -> tuple[list[float], list[Task], list[str]]:
    """Return the values of a quantity that have a task, their tasks, and the words for those that have none."""
    values, tasks, refusals = [], [], []
    for value in np.linspace(*RANGES[over], count).tolist():
        try:
            tasks.append(task_at(scenario, over, value))
            values.append(value)
        except RailjouleError as refusal:
            refusals.append(f"{over} {value:.4g}: {refusal}")
    if over != "time" and tasks:
        longest = TIME_SHARE * max(task.shortest_time_s for task in tasks)
        tasks = [replace(task, running_time_s=longest) for task in tasks]
    return values, tasks, refusals


def _sense(over: str, tasks: Iterable[Task]) -> int:
    """Return the sense of energies over a quantity, as in `Sweep`."""
    if over == "load":
        return int(all(task.course.gradient_force_n @ task.course.data.cell_length_m >= 0 for task in tasks))
    return -1 if over == "time" else 1


def roughness(values: FloatArray, energy_j: FloatArray, reference_j: FloatArray) -> FloatArray:
    """Return by which share each energy but the outer two is off the cubic through its neighbours; shape (m - 4,)."""
    middle = np.arange(2, len(values) - 2)
    neighbours = middle[:, None] + np.array([-2, -1, 1, 2])
    x = values[neighbours] - values[middle, None]
    # Lagrange's weights at 0: a value that was refused leaves neighbours unevenly far
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
    weights = np.prod(x[:, others] / (x[:, others] - x[:, :, None]), axis=2)
    off: FloatArray = np.abs((weights * energy_j[neighbours]).sum(axis=1) - energy_j[middle]) / reference_j[middle]
    return off


def _rough_places(values: FloatArray, energy_j: FloatArray, reference_j: FloatArray) -> list[int]:
    """Return which energies are off the cubic, of those beside one another the worst."""
    if len(values) < 5:
        return []
    off = np.concatenate([[0.0, 0.0], roughness(values, energy_j, reference_j), [0.0, 0.0]])
    return [i for i in range(2, len(off) - 2) if off[i] > ROUGH and off[i] >= off[i - 1 : i + 2].max()]


def _jump(
    scenario: Scenario, over: str, time_s: float, values: FloatArray, energy_j: FloatArray, reference_j: float
) -> tuple[float, float]:
    """Return by which share the energy jumps between the second and the fourth of five values, and where."""
    for _ in range(ZOOMS):
        inner = np.linspace(values[1], values[3], 9)
        try:
            found = [energy_at(scenario, over, value, time_s) for value in inner[1:-1].tolist()]
        except RailjouleError:
            return np.inf, float(values[2])
        x = np.concatenate([values[:1], inner, values[4:]])
        energy = np.concatenate([energy_j[:2], found, energy_j[3:]])
        off = roughness(x, energy, np.full(len(x), reference_j))
        roughest = int(off.argmax())
        jump, values, energy_j = 2 * float(off.max()), x[roughest : roughest + 5], energy[roughest : roughest + 5]
        if jump < NO_JUMP:
            break
    return jump, float(values[2])


def energy_at(scenario: Scenario, over: str, value: float, running_time_s: float) -> float:
    """Return the least energy at a value of a quantity [J]."""
    run = run_strategy(task_at(scenario, over, value, running_time_s), "optimal")
    return run.energy.net_j


# ---- the table

COLUMNS = (
    *("drive", "scenario", "over", "runs", "against its sense", "jump", "off a smooth curve", "refused", "no bound"),
    *("gap > 1e-3", "bounds against", "s"),
)
HEAD = f"| {' | '.join(COLUMNS)} |\n|{' --- |' * len(COLUMNS)}"


def row(sweep: Sweep) -> str:
    """Return a row of the table."""
    against = f"{sweep.against:.1e}" if sweep.sense else "no sense"
    jump = f"{sweep.jump:.1e} at {sweep.jump_at:.5g}" if sweep.jump else f"under {2 * ROUGH:.0e}"
    # no energy has two neighbours on either side
    jump = jump if len(sweep.values) >= 5 else "too few"
    return (
        f"| {sweep.case.scenario.vehicle.drive.model} | {sweep.case.name} | {sweep.over} | {len(sweep.values)} | "
        f"{against} | {jump} | {sweep.roughness:.1e} | {len(sweep.refusals)} | {sweep.unbounded} | {sweep.wide} | "
        f"{sweep.bounds_against:.1e} | {sweep.seconds:.1f} |"
    )


def main() -> None:
    """Sweep, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.sweep_energy", description=__doc__)
    parser.add_argument("--drive", choices=MODELS, nargs="*", default=MODELS, help="kinds of drives")
    parser.add_argument("--over", choices=RANGES, nargs="*", default=list(RANGES))
    parser.add_argument("--thin", type=int, default=1, metavar="N", help="sweep over one value in N")
    parser.add_argument("--random", type=int, default=0, metavar="N", help="sweep N random scenarios instead")
    asked = parser.parse_args()
    chosen = random_cases(range(asked.random), asked.drive) if asked.random else cases(asked.drive)
    print(HEAD)
    refusals: list[str] = []
    for case in chosen:
        for over in asked.over:
            sweep = swept(case, over, COUNTS[over] // asked.thin)
            refusals += [f"{case.name}, {refusal}" for refusal in sweep.refusals]
            print(row(sweep), flush=True)
    print("\n".join(["", *refusals]))


if __name__ == "__main__":
    main()
