"""Random scenarios by which bounds are judged: those of `any_scenarios` on lines of 0.3 to 10 km, with tight times."""

from functools import cache
from typing import Any

import numpy as np

from railjoule.core.scenario import Scenario, load_scenario, preset_names, scenario_from_document
from railjoule.core.strategies import prepare_task
from tests.any_scenarios import any_wide_document

LENGTHS_M, MESHES_M = (300.0, 10_000.0), (2.0, 40.0)
SLACK_SHARES = (0.001, 2.0)
"""Times are 1.001 to 3 times the shortest one; half of them lie below 1.045."""
MAX_CELLS, MOST_TIME_S = 1500, 40_000.0
PLACES = ("from_m", "to_m", "position_m")

Table = dict[str, Any]


@cache
def judged_scenario(name: str) -> Scenario:
    """Return a shipped scenario by its name, or a random one by its seed in digits.

    Raises
    ------
    RailjouleError
        If no run passes the line of the seed.
    """
    if not name.isdigit():
        return load_scenario(name)
    document = judged_document(int(name))
    task = prepare_task(scenario_from_document(document))
    slack = _spread(np.random.default_rng([int(name), 6]), SLACK_SHARES)
    total_s = task.shortest_time_s * (1 + slack) + task.dwell_s
    document["timetable"]["travel_time_s"] = min(total_s, max(MOST_TIME_S, task.shortest_travel_time_s * 1.001))
    return scenario_from_document(document)


def judged_document(seed: int) -> Table:
    """Return the scenario of a seed as a nested dictionary, with a time for any run; drives take turns by the seed."""
    rng, document = np.random.default_rng([seed, 5]), any_wide_document(seed)
    length = sum(section["length_m"] for section in document["line"]["sections"])
    wanted = _spread(rng, LENGTHS_M)
    _stretch(document["line"], wanted / length)
    document["search"]["boundaries_m"] = [place * wanted / length for place in document["search"]["boundaries_m"]]
    _add_limits(rng, document, wanted)
    document["solver"]["mesh_m"] = max(_spread(rng, MESHES_M), wanted / MAX_CELLS)
    return document


def _add_limits(rng: np.random.Generator, document: Table, length_m: float) -> None:
    """Add further speed limits, from half a metre to a third of the line, and speeds at the ends, to some."""
    top, line = document["vehicle"]["traction"]["max_speed_kmh"], document["line"]
    # EOC and ENOC refuse these, and take only plain lines
    if len(line["sections"]) == 1:
        return
    for _ in range(int(rng.choice([0, 0, 1, 2, 3]))):
        start = float(rng.uniform(0, 0.9)) * length_m
        end = min(start + _spread(rng, (0.5, 0.3 * length_m)), length_m)
        limit = {"from_m": start, "to_m": end, "limit_kmh": top * float(rng.uniform(0.3, 0.9))}
        line["speed_limits"] = [*line.get("speed_limits", ()), limit]
    for key in ("entry_speed_kmh", "exit_speed_kmh"):
        if rng.random() < 0.25:
            document["timetable"].setdefault(key, float(rng.uniform(0.05, 0.4)) * top)


def shipped_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios."""
    return preset_names("scenarios")


def _spread(rng: np.random.Generator, ends: tuple[float, float]) -> float:
    """Return a number between two, evenly by its logarithm."""
    return float(np.exp(rng.uniform(*np.log(ends))))


def _stretch(line: Table, factor: float) -> None:
    """Multiply all places and lengths of a line."""
    for section in line["sections"]:
        section["length_m"] *= factor
    for key in ("speed_limits", "stations", "passing_points", "neutral_sections"):
        for row in line.get(key, ()):
            row.update({name: row[name] * factor for name in PLACES if name in row})
