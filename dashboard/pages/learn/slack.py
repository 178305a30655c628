"""The lesson on the supplement: two lines of three legs, the energy of each over its seconds, and the best of them."""

import re
from functools import cache
from itertools import accumulate
from typing import Any

from railjoule.core import Scenario, ScenarioError, load_scenario
from railjoule.core.energy import share_above
from railjoule.core.strategies.line_parts import shortest_times_s, stop_nodes
from railjoule.core.studies.table import StudyTable
from railjoule.core.studies.whole_line import Leg, WholeLine, leg_tables, shared_line
from railjoule.core.task import Task, prepare_task
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.verdict import Verdict

BASE = "metro-10-stations"
"""Train, load and recuperation are those of this scenario."""
NAMES = ("Harbour", "Old Town", "University", "Hill")
# assumed: the first line has one long leg between short ones, the second has legs nearly alike
LENGTHS_M = {"uneven": (400.0, 2000.0, 600.0), "even": (1100.0, 1350.0, 1050.0)}
SLACK_S, DWELL_S = 60, 25.0
"""Supplement to distribute over the shortest times, and dwell time at each intermediate station [s]."""
LEAST_S = 1
"""No leg gets less, as the shortest time itself leaves nothing to choose."""
MOST_S = SLACK_S - LEAST_S * (len(NAMES) - 2)
SHARED = re.compile(r"(uneven|even):(\d{1,2}),(\d{1,2}),(\d{1,2})")
# seconds are dragged whole, so that less than one is no difference
ALIKE_S = 1.0
AS_BEST = "{leg}: as in the best distribution, within a second."
BEST = (
    "Best, as the dashed borders: {seconds} s. There, one more second saves {price} Wh on every leg: moving a second "
    "gains nothing."
)
TOO_MANY = "{leg}: {seconds} s too many. Here one more second saves only {price} Wh."
TOO_FEW = "{leg}: {seconds} s too few. Here one more second would save {price} Wh."


def begin(text: str) -> dict[str, Any]:
    """Return the initial data of the browser: both lines, and equal seconds on the first or the distribution of a link.

    Raises
    ------
    ScenarioError
        If the text is no distribution on these lines.
    """
    line, seconds = read_sharing(text or "uneven:20,20,20")
    return {"lines": {name: line_tables(name) for name in LENGTHS_M}, "line": line, "seconds": list(seconds)}


def read_sharing(text: str) -> tuple[str, tuple[int, ...]]:
    """Return the name of a line and the seconds of its legs from a text.

    Raises
    ------
    ScenarioError
        If it names no line, or its seconds are not those that there are to share out.
    """
    found = SHARED.fullmatch(text)
    seconds = tuple(int(one) for one in found.groups()[1:]) if found else ()
    if not found or min(seconds) < LEAST_S or sum(seconds) != SLACK_S:
        raise ScenarioError(
            f"shared must be uneven: or even: with three whole numbers of at least {LEAST_S} that sum to {SLACK_S}."
        )
    return found[1], seconds


@cache
def leg_task(name: str) -> Task:
    """Return the task of a line, whose travel time leaves SLACK_S over the shortest times."""
    wide = _scenario(name, 3600.0)
    stops = stop_nodes(prepare_task(wide))
    shortest = float(shortest_times_s(prepare_task(wide), stops).sum())
    return prepare_task(_scenario(name, shortest + SLACK_S + DWELL_S * (len(NAMES) - 2)))


def shared_scenario(name: str, seconds: tuple[int, ...]) -> Scenario:
    """Return a line whose given timetable is a distribution."""
    task = leg_task(name)
    shortest = shortest_times_s(task, stop_nodes(task))
    running = [float(least) + more for least, more in zip(shortest, seconds, strict=True)]
    arrivals = [time + k * DWELL_S for k, time in enumerate(accumulate(running))][:-1]
    return task.scenario.replace(**{"line.stations": _stations(name, arrivals)})


def opened(text: str) -> Scenario:
    """Return a line whose timetable is a distribution; errors as `judge`."""
    return shared_scenario(*read_sharing(text))


@cache
def line_tables(name: str) -> dict[str, Any]:
    """Return a line as the browser takes it: each leg's energy and price at each whole second of slack."""
    task = leg_task(name)
    dwells = DWELL_S * (len(NAMES) - 2)
    tables = leg_tables(task, range(LEAST_S, MOST_S + 1))
    # what the train takes while it stands is the same however the seconds are shared
    standing_j = task.mesh.data.auxiliary_power_w * dwells
    return {
        "legs": [_leg(name, k, table) for k, table in enumerate(tables)],
        "standing_kwh": standing_j / J_PER_KWH,
        "min_s": LEAST_S,
        "slack_s": SLACK_S,
    }


@cache
def best_line(name: str) -> WholeLine:
    """Return the optimum of a line."""
    return shared_line(leg_task(name), "optimum")


def driven_line(name: str, seconds: tuple[int, ...]) -> WholeLine:
    """Return the run of least energy under a sharing."""
    return shared_line(prepare_task(shared_scenario(name, seconds)), "given")


def judge(text: str) -> Verdict:
    """Compare a distribution with the best one.

    Raises
    ------
    ScenarioError
        If the text is no distribution on these lines.
    """
    name, seconds = read_sharing(text)
    mine, best, legs = driven_line(name, seconds), best_line(name), len(LENGTHS_M[name])
    bound = best.run.bound
    assert bound is not None
    equal = driven_line(name, (SLACK_S // legs,) * legs)
    best_s = [leg.supplement_s for leg in best.legs]
    sentences = [_on_leg(*pair) for pair in zip(mine.legs, best.legs, strict=True)]
    sentences += [
        BEST.format(seconds=", ".join(map(words.time, best_s)), price=words.price(best.legs[0].price_of_time_w)),
        _worth(share_above(equal.run.energy_kwh, best.run.energy_kwh)),
    ]
    return Verdict(
        "shared",
        text,
        kwh=mine.run.energy_kwh,
        bound_kwh=bound.energy_j / J_PER_KWH,
        proven=best.run.is_proven,
        curves={"best_s": best_s},
        sentences=tuple(sentences),
    )


def _on_leg(mine: Leg, best: Leg) -> str:
    """Return a sentence that compares the supplement of a leg with the best one."""
    more = mine.supplement_s - best.supplement_s
    sentence = AS_BEST if abs(more) < ALIKE_S else TOO_MANY if more > 0 else TOO_FEW
    return sentence.format(
        leg=f"{mine.departs_from} \u2013 {mine.arrives_at}",
        seconds=words.time(abs(more)),
        price=words.price(mine.price_of_time_w),
    )


def _worth(share: float) -> str:
    """Return sentences on the cost of an equal supplement on a line, and on the use of a better distribution."""
    costs = f"An equal supplement costs {100 * share:.2f} % more than the best distribution"
    # as on the page Line: a load or a day's weather moves the energy by more
    if share >= 0.01:
        return f"{costs}: on this line, distributing it pays."
    return f"{costs}: on this line it does not pay. A few more passengers change more."


def _leg(name: str, number: int, table: StudyTable) -> dict[str, Any]:
    return {
        "from": NAMES[number],
        "to": NAMES[number + 1],
        "length_m": LENGTHS_M[name][number],
        "shortest_s": table.shortest_time_s,
        "energy_kwh": table["energy_kwh"].tolist(),
        "price_wh_s": table["price_of_time_wh_per_s"].tolist(),
    }


def _scenario(name: str, travel_time_s: float) -> Scenario:
    sections = [section for length in LENGTHS_M[name] for section in _hump(length)]
    line = {"name": f"Three {name} legs (assumed)", "sections": sections, "stations": _stations(name)}
    title = f"Distribute the supplement: {name} legs"
    return load_scenario(BASE).replace(title=title, line=line, **{"timetable.travel_time_s": travel_time_s})


def _hump(length_m: float) -> list[dict[str, float]]:
    """Return a leg between stations on humps, as metros have them."""
    level, slope = {"length_m": 60.0}, 100.0
    down, up = ({"length_m": slope, "gradient_permille": gradient} for gradient in (-20.0, 20.0))
    between = {"length_m": length_m - 2 * (level["length_m"] + slope)}
    return [level, down, between, up, level]


def _stations(name: str, arrivals_s: list[float] | None = None) -> list[dict[str, Any]]:
    places = [0.0, *accumulate(LENGTHS_M[name])]
    rows: list[dict[str, Any]] = [
        {"name": name, "position_m": place} for name, place in zip(NAMES, places, strict=True)
    ]
    for row in rows[1:-1]:
        row["dwell_s"] = DWELL_S
    for row, arrival in zip(rows[1:-1], arrivals_s or (), strict=False):
        row["arrival_s"] = arrival
    return rows
