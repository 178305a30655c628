"""The run of least energy under windows of arrival, and the bound of all runs that keep them.

Windows of arrival are inequalities on the sums of the legs' times. The optimum under them is found by an active set:
the window that is missed most is fixed at the end that it misses, until none is missed; one whose fixing costs energy
instead of keeping the window is let go. The prices of a second tell: where a window's end binds as the latest arrival,
a second is worth more before the station than after it, and less where it binds as the earliest. Behind the end of the
line a second is worth the auxiliaries' power, as they are off by then.
"""

from collections.abc import Mapping

import numpy as np

from railjoule.core.bounds import every_run_statement, time_line, work_floor_j
from railjoule.core.chain_proof.table import premise
from railjoule.core.errors import ScenarioError
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.lower_bound import ON_TIME_S, Bound, Window
from railjoule.core.strategies.line_parts import (
    LineParts,
    Part,
    Solver,
    TimedRun,
    arrival_name,
    arrival_times_s,
    cut_part,
    inner_stations,
    longest_time_s,
    parts_between,
    shortest_times_s,
    stop_nodes,
    timed_run,
    with_auxiliaries,
)
from railjoule.core.task import MIN_SLACK, Task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH, distinct_numbers

Windows = Mapping[int, tuple[float, float]]
"""Earliest and latest arrival [s] by the number of a station, counted from 0 behind the start; the last is the end."""
# Of the shortest time between two stations: with less, the optimum between two fixed arrivals has hardly an inside, and
# with more, windows would be narrower than they are
SPARE_SHARE = 1e-4
# of the price: by less, both sides of a station value a second alike
SAME_PRICE = 1e-6
MAX_NAMED = 3
"""Stations that a statement names; more are counted."""


def arrival_windows(task: Task) -> dict[int, tuple[float, float]]:
    """Return the windows of arrival of a task's stations, where they have one; its time is no window of its own."""
    stations = inner_stations(task)
    windows = {k: s.window_s for k, s in enumerate(stations) if s.window_s != (0.0, np.inf)}
    end = task.scenario.line.end_station
    if end is not None and end.earliest_arrival_s:
        windows[len(stations)] = end.earliest_arrival_s, task.travel_time_s
    return windows


def missed_windows(task: Task, run: Trajectory) -> tuple[str, ...]:
    """Return a sentence on each window of arrival that a run misses."""
    notes, windows = [], arrival_windows(task)
    for number, window in zip(windows, _with_places(task, windows), strict=True):
        if run.keeps(window):
            continue
        place, low, high = window
        arrival = run.arrival_s(place)
        side, asked = ("earlier", low) if arrival < low else ("later", high)
        said, wanted = _distinct_times(arrival, asked)
        notes.append(
            f"It arrives at {arrival_name(task, number)} after {said} s, and was to arrive no {side} than {wanted} s."
        )
    return tuple(notes)


def _distinct_times(one_s: float, other_s: float) -> tuple[str, str]:
    """Return two times in tenths of a second, or with as many digits as it takes to distinguish them."""
    words = f"{one_s:.1f}", f"{other_s:.1f}"
    return words if words[0] != words[1] else distinct_numbers(one_s, other_s)


def _with_places(task: Task, windows: Windows) -> tuple[Window, ...]:
    """Return windows with the positions of their stations."""
    stops, position_m = stop_nodes(task), task.mesh.position_m
    return tuple((float(position_m[stops[number + 1]]), low, high) for number, (low, high) in windows.items())


def require_windows(task: Task, windows: Windows) -> None:
    """Raise ScenarioError if no train keeps all windows: the first one that fails is named."""
    stops = stop_nodes(task)
    dwell, shortest = task.mesh.dwell_s[stops], shortest_times_s(task, stops)
    ready_s = 0.0
    # as early as possible at each station: a train that is late then, is always late
    for number, least in enumerate(shortest):
        reached_s = ready_s + float(least)
        earliest, latest = windows.get(number, (0.0, np.inf))
        if number == len(shortest) - 1:
            latest = min(latest, task.travel_time_s)
            if earliest > latest:
                raise ScenarioError(
                    f"earliest_arrival_s = {earliest:g} s at {arrival_name(task, number)} must be no later than the "
                    f"{latest:g} s that the timetable allows for the whole run."
                )
        possible_s = max(reached_s * (1 + MIN_SLACK), earliest)
        if number == 0:
            _require_slow_first_leg(task, stops[1], earliest)
        if reached_s * (1 + MIN_SLACK) >= latest or earliest > latest:
            waited = ready_s > float(dwell[: number + 1].sum() + shortest[:number].sum())
            kept = " with the windows of arrival before it" if waited else ""
            asked, possible = _distinct_times(latest, possible_s)
            reason = "is possible after" if reached_s >= earliest else "no earlier than"
            where = arrival_name(task, number)
            raise ScenarioError(
                f"The arrival at {where} must be no later than {asked} s, and {reason} {possible} s{kept}."
            )
        ready_s = max(reached_s, earliest) + float(dwell[number + 1])


def _require_slow_first_leg(task: Task, stop: int, earliest_s: float) -> None:
    """Raise ScenarioError if a train that enters in motion cannot be slow enough for its first arrival."""
    entry_speed2 = float(task.mesh.data.fixed_speed2[0])
    if entry_speed2 == 0.0 or earliest_s == 0.0:
        return
    latest_s = longest_time_s(task, stop)
    if earliest_s > latest_s + ON_TIME_S:
        where = arrival_name(task, 0)
        asked, possible = _distinct_times(earliest_s, latest_s)
        raise ScenarioError(
            f"The arrival at {where} must be no earlier than {asked} s, but the train enters at "
            f"{np.sqrt(entry_speed2) / MS_PER_KMH:.1f} km/h and arrives there after {possible} s at the latest: it "
            f"brakes fully from the start and then runs at {np.sqrt(SLOWEST_SPEED2) / MS_PER_KMH:g} km/h, the lowest "
            "speed of a run. Allow an earlier arrival, or lower the entry speed."
        )


def _possible(task: Task, windows: Windows, spare_share: float) -> dict[int, tuple[float, float]]:
    """Return windows without the arrivals that the legs and the other windows rule out.

    Any two ends can then be fixed together: the search may fix one that another one leaves no time for.
    """
    stops = stop_nodes(task)
    dwell, least = task.mesh.dwell_s[stops], (1 + spare_share) * shortest_times_s(task, stops)
    low, high = np.zeros(len(stops)), np.full(len(stops), np.inf)
    high[-1] = task.travel_time_s
    for number, (earliest, latest) in windows.items():
        low[number + 1], high[number + 1] = earliest, min(latest, high[number + 1])
    for k in range(1, len(stops)):
        low[k] = max(low[k], low[k - 1] + dwell[k - 1] + least[k - 1])
    for k in range(len(stops) - 2, 0, -1):
        high[k] = min(high[k], high[k + 1] - dwell[k] - least[k])
    # so close to the shortest times that the spare is more than there is: the window itself stands
    return {
        number: (float(low[number + 1]), float(high[number + 1])) if low[number + 1] <= high[number + 1] else window
        for number, window in windows.items()
    }


def optimum_within(task: Task, windows: Windows, optimum: Solver) -> LineParts:
    """Return the runs of least energy of a line whose windows of arrival are kept.

    Parameters
    ----------
    task : Task
    windows : mapping of int to (float, float)
        Earliest and latest arrival [s] by the number of the station.
    optimum : callable
        The best run of a task without windows.

    Raises
    ------
    ScenarioError
        If no train keeps them.
    SolverError
        If no run of a part is found.
    """
    require_windows(task, windows)
    possible = _possible(task, windows, SPARE_SHARE)
    # two equal ends are no choice
    fixed = {number: low for number, (low, high) in possible.items() if low == high}
    solved: dict[tuple[Part, bool], TimedRun] = {}
    best: LineParts | None = None
    trials = 0
    while True:
        # each window is fixed at most once at each of its ends, and let go as often; where prices lead to and fro, none
        # is let go any more
        is_last = trials > 4 * len(possible)
        if is_last and best is not None:
            return best
        trials += 1
        line = timed_line(task, fixed, optimum, solved)
        missed = _max_missed(task, line, possible, fixed)
        if missed is not None:
            fixed[missed[0]] = missed[1]
            continue
        if best is None or energy_j(task, line) < energy_j(task, best):
            best = line
        free = None if is_last else _needlessly_fixed(task, line, possible, fixed)
        if free is None:
            return best
        del fixed[free]


def timed_line(
    task: Task,
    fixed: Mapping[int, float],
    optimum: Solver,
    solved: dict[tuple[Part, bool], TimedRun] | None = None,
) -> LineParts:
    """Return the runs of least energy with fixed arrivals; those that are solved already are taken from `solved`."""
    solved = {} if solved is None else solved
    parts = parts_between(task, fixed)
    exactly = [*[True] * (len(parts) - 1), len(inner_stations(task)) in fixed]
    for given in zip(parts, exactly, strict=True):
        if given not in solved:
            solved[given] = timed_run(task, given[0], optimum, given[1])
    return tuple(solved[given] for given in zip(parts, exactly, strict=True))


def energy_j(task: Task, line: LineParts) -> float:
    """Return the energy of runs that follow one another, auxiliaries and dwells included [J]."""
    total, departed_s = 0.0, 0.0
    for timed in line:
        total += timed.run.energy.net_j
        if timed.takes_exactly:
            # the train stands behind the first node of a part, at its last one included
            standing_s = float(task.mesh.dwell_s[timed.part.first + 1 : timed.part.last + 1].sum())
            # a run that is slowed by a reward for time is counted without it
            total -= timed.run.energy.auxiliary_j
            departed_s += timed.part.running_time_s + standing_s
    return total + task.mesh.data.auxiliary_power_w * departed_s


def _max_missed(task: Task, line: LineParts, windows: Windows, fixed: Mapping[int, float]) -> tuple[int, float] | None:
    """Return the free station that misses its window by most, and the end that it misses; None where none does."""
    arrivals = arrival_times_s(task, line)
    nearest = {k: min(max(arrivals[k], low), high) for k, (low, high) in windows.items() if k not in fixed}
    missed_s, number = max(((abs(arrivals[k] - end), k) for k, end in nearest.items()), default=(0.0, 0))
    return (number, nearest[number]) if missed_s > ON_TIME_S else None


def _needlessly_fixed(task: Task, line: LineParts, windows: Windows, fixed: Mapping[int, float]) -> int | None:
    """Return a station fixed at an end of its window that the optimum leaves to the inside, if there is one."""
    auxiliary_w = task.mesh.data.auxiliary_power_w
    prices = [
        None if timed.price_of_time_w is None else timed.price_of_time_w + (0.0 if timed.takes_exactly else auxiliary_w)
        for timed in line
    ]
    for order, number in enumerate(sorted(fixed)):
        low, high = windows[number]
        before, after = prices[order], [*prices, auxiliary_w][order + 1]
        if low == high or before is None or after is None:
            continue
        # a later arrival gives the part before a second and takes it from the part after
        gain = (before - after) / max(abs(before), abs(after), 1.0)
        if (fixed[number] == low and gain > SAME_PRICE) or (fixed[number] == high and gain < -SAME_PRICE):
            return number
    return None


def binding_windows(task: Task, line: LineParts, windows: Windows) -> tuple[Window, ...]:
    """Return all windows of arrival if one of them binds the runs of least energy that keep them, else none."""
    return _with_places(task, windows) if len(line) > 1 or line[0].takes_exactly else ()


def bound_within(task: Task, line: LineParts, windows: Windows) -> Bound | None:
    """Return the lower bound of all runs that keep windows of arrival, from the prices of runs that do.

    A line below the least energy of each part over its time, see `railjoule.core.bounds.time_line`, holds for all its
    times. So the sum of these lines is linear in the arrivals, and least at ends of the windows: at those of the runs
    if these are the optimum.

    Parameters
    ----------
    task : Task
    line : tuple of TimedRun
        The runs: where one ends at a fixed arrival, `windows` has its station.
    windows : mapping of int to (float, float)

    Returns
    -------
    Bound or None
        None where the optimum of a part is not found.
    """
    if not binding_windows(task, line, windows):
        # the bound of the whole line covers these runs as well
        return line[0].bound
    stops = stop_nodes(task)
    possible = _possible(task, windows, 0.0)
    ends = {stops[number + 1]: window for number, window in possible.items()}
    arrivals = dict(zip(stops[1:], arrival_times_s(task, line), strict=True))
    exact = {0, *(node for node, (low, high) in ends.items() if low == high)}
    if not line[-1].takes_exactly:
        # its own bound covers any earlier end
        exact.add(stops[-1])
    total_j, slopes_w = 0.0, dict.fromkeys(arrivals, 0.0)
    for timed in line:
        first, last, _ = timed.part
        bound = timed.bound
        if bound is None:
            return None
        price_w, proven_j = 0.0, bound.energy_j
        if not {first, last} <= exact:
            part = cut_part(task, *timed.part)
            proven = time_line(with_auxiliaries(part, 0.0) if timed.takes_exactly else part)
            if proven is None:
                return None
            proven_j, price_w = proven.energy_j, proven.price_of_time_w
        total_j += proven_j
        slopes_w[last] -= price_w
        if first > 0:
            slopes_w[first] += price_w
        # auxiliaries up to the end of the part, or up to its start where its own energy has the rest
        if timed is line[-1] and (timed.takes_exactly or first > 0):
            until = last if timed.takes_exactly else first
            dwell_s = 0.0 if timed.takes_exactly else float(task.mesh.dwell_s[first])
            total_j += task.mesh.data.auxiliary_power_w * (arrivals[until] + dwell_s)
            slopes_w[until] += task.mesh.data.auxiliary_power_w
    for node, (low, high) in ends.items():
        if node in {timed.part.last for timed in line} and node not in exact:
            total_j += min(slopes_w[node] * (low - arrivals[node]), slopes_w[node] * (high - arrivals[node]))
    total_j = max(total_j, work_floor_j(task))
    statement = every_run_statement(task, total_j, _words(task, windows))
    assumed, kept = premise(task.mesh.data.drive_kind), _with_places(task, windows)
    return Bound(total_j, statement, task.travel_time_s, total_j, premise=assumed, windows=kept)


def _words(task: Task, windows: Windows) -> str:
    """Return windows of arrival in words, as what a run keeps beside its limits."""
    names = [arrival_name(task, number) for number in sorted(windows)]
    listed = " and ".join([", ".join(names[:-1])] * (len(names) > 1) + names[-1:])
    return f" and the windows of arrival at {listed if len(names) <= MAX_NAMED else f'{len(names)} stations'}"
