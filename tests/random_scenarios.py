"""Random but feasible scenarios, as varied as the solver's users could make them."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.errors import RailjouleError
from railjoule.core.motion.meshed_line import MeshedLine, build_meshed_line
from railjoule.core.motion.passes import MOVED, max_speeds, running_time
from railjoule.core.scenario import Scenario, scenario_from_document
from railjoule.core.task import Task


@dataclass(frozen=True, eq=False)
class RandomRun:
    """A scenario with its meshed line and its shortest time [s], dwells not included."""

    scenario: Scenario
    mesh: MeshedLine
    fastest_speed2: np.ndarray
    shortest_time_s: float
    running_time_s: float

    @property
    def task(self) -> Task:
        """The same as strategies take it."""
        return Task(self.scenario, self.mesh, self.fastest_speed2, self.shortest_time_s, self.running_time_s)


def random_run(seed: int, stops: bool) -> RandomRun:
    """Return the first feasible scenario that the generator of `seed` draws, with one to three stops if asked."""
    rng = np.random.default_rng(seed)
    while True:
        boundary_speed = float(rng.choice([0.0, 1.0]))
        scenario = _draw(rng, stops)
        try:
            mesh = build_meshed_line(scenario, boundary_speed, boundary_speed)
        except RailjouleError:
            continue
        fastest, obstacle, _ = max_speeds(mesh.data)
        if obstacle != MOVED or fastest[1:-1].max() < 1.0:
            continue
        shortest = running_time(mesh.data.cell_length_m, fastest)
        allowed = shortest * _slack_factor(rng)
        if allowed > 20_000:
            continue
        return RandomRun(scenario, mesh, fastest, shortest, allowed)


def random_speeds(task: Task, seed: int) -> np.ndarray:
    """Return squares of speed of a feasible run in the time allowed: the fastest one under caps that `seed` draws."""
    data = task.mesh.data
    places = np.linspace(0, task.mesh.length_m, 8)
    shape = np.interp(task.mesh.position_m, places, np.random.default_rng(seed).uniform(0.2, 1.0, len(places)))
    low, high, found = 0.0, 5 * data.limit_speed2.max() ** 0.5, task.fastest_speed2
    for _ in range(30):
        cap = 0.5 * (low + high)
        capped = np.minimum(data.limit_speed2, (cap * shape) ** 2)
        speed2, obstacle, _ = max_speeds(data._replace(limit_speed2=capped))
        if obstacle == MOVED and running_time(data.cell_length_m, speed2) <= task.running_time_s:
            high, found = cap, speed2
        else:
            low = cap
    return found


def _slack_factor(rng: np.random.Generator) -> float:
    """A tenth within 2 % of the shortest time, a sixth slower than twice it."""
    kind = rng.random()
    if kind < 0.10:
        return 1 + rng.uniform(0.0005, 0.02)
    if kind < 0.84:
        return rng.uniform(1.02, 2.0)
    return rng.uniform(2.0, 6.0)


def _draw(rng: np.random.Generator, stops: bool) -> Scenario:
    length = rng.uniform(300, 3000)
    tare = float(10 ** rng.uniform(4.3, 5.8))
    effort = tare * rng.uniform(0.7, 1.6) / 1000
    speed = rng.uniform(40, 160)
    document = {
        "title": "random",
        "vehicle": {
            "name": "random",
            "tare_kg": tare,
            "rotating_mass_factor": rng.uniform(0, 0.3),
            "resistance": _resistance(rng),
            "traction": {"max_effort_kn": effort, "max_speed_kmh": speed},
            "braking": {"max_effort_kn": effort * rng.uniform(0.6, 1.5)},
            "drive": _drive(rng, effort, tare),
        },
        "line": {"sections": _sections(rng, length)},
        "timetable": {"travel_time_s": 100},
        "solver": {"mesh_m": rng.uniform(2, 20)},
    }
    if rng.random() < 0.7:
        document["vehicle"]["traction"]["max_power_kw"] = effort * speed / 3.6 * rng.uniform(0.2, 1)
    if rng.random() < 0.5:
        document["vehicle"]["braking"]["max_power_kw"] = effort * speed / 3.6 * rng.uniform(0.3, 1.2)
    if stops:
        count = int(rng.integers(1, 4))
        places = np.linspace(0, length, count + 2)[1:-1] + rng.uniform(-0.1, 0.1, count) * length / (count + 1)
        document["line"]["stations"] = [{"position_m": float(place)} for place in places]
    return scenario_from_document(document)


def _resistance(rng: np.random.Generator) -> dict[str, float]:
    return {
        "constant_n_per_kn": rng.uniform(0.5, 4),
        "linear_n_per_kn_per_kmh": rng.uniform(0.002, 0.05) if rng.random() < 0.6 else 0.0,
        "quadratic_n_per_kn_per_kmh2": rng.uniform(0.0001, 0.001),
    }


def _drive(rng: np.random.Generator, effort_kn: float, tare_kg: float) -> dict[str, object]:
    recuperation = float(rng.choice([0.0, 1.0, rng.uniform(0, 1)]))
    if rng.random() < 0.6:
        loss_share = rng.uniform(0.02, 0.3)
        motor = {"motors": 4, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "torque_per_amp_nm": 5.0}
        amperes = effort_kn * 1000 / (4 * 5.0 * 5.0 / 0.4)
        resistance = loss_share * effort_kn * 1000 * 10 / (4 * amperes**2)
        return {"model": "copper_loss", "recuperation_factor": recuperation, "resistance_ohm": resistance, **motor}
    return {
        "model": "constant_efficiency",
        "recuperation_factor": recuperation,
        "traction_efficiency": rng.uniform(0.7, 1),
    }


def _sections(rng: np.random.Generator, length: float) -> list[dict[str, float]]:
    count = int(rng.integers(1, 13))
    shares = rng.dirichlet(np.ones(count)) * 0.9 + 0.1 / count
    sections = []
    for share in shares:
        section = {"length_m": float(share * length), "gradient_permille": float(rng.uniform(-40, 40))}
        if rng.random() < 0.25:
            section["speed_limit_kmh"] = float(rng.uniform(25, 120))
        sections.append(section)
    return sections
