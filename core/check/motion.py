"""Rules of motion: places, times, stops, speeds, accelerations, arrival, and the balance of forces.

In a cell the net force is constant, so v^2 is linear over distance: a cell of the length h takes 2 h / (v0 + v1) and
its acceleration is (v1^2 - v0^2) / (2 h).
"""

from collections.abc import Iterator
from itertools import starmap

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.case import Case
from railjoule.core.check.result import Check, Finding, Unchecked, find_largest
from railjoule.core.units import MS_PER_KMH, N_PER_KN

# places of a table are read from text: stations are found again within a hundredth of a millimetre
SAME_PLACE_M = 1e-5
# Places and times are sums of a few thousand terms in double precision, good to 1e-12: 1e-7 is met by a right run with
# ease and missed by any run that skips a second or a metre. Forces carry the rounding of v^2, hence 1e-5.
ROUNDING, ROUNDED_GRADIENT, ROUNDED_FORCE = 1e-7, 1e-10, 1e-5
# 1e-6 of a limit of 80 km/h is 0.1 m/h: above the tolerances of the solvers, far below what anybody means by speeding
ROUNDED_SPEED, ROUNDED_ACCELERATION = 1e-6, 1e-5
# distance goes with the square of speed: twice the share of a speed, and more where the deceleration steps
ROUNDED_CURVE = 1e-5
# the resistance changes with the speed within a step of the effort
ROUNDED_JERK = 0.01
LATE_S, LATE_SHARE = 1e-6, 2e-9
# a window is kept to a hundredth of a millisecond, and times of a table are written with ten digits
MISSED_S = 1e-4
"""A timetable is kept to a millionth of a second, or to the rounding of a long sum of times."""
# With a price of time every second before the arrival costs energy, so an optimum is never early, but for its own
# tolerance. An early arrival is judged by that cost, as seconds mean little on a flat optimum.
EARLY_ARRIVAL_COST = 1e-5
"""An early arrival may cost what five digits of the energy do not tell."""
# of the weight: where a train coasts at its steady speed both forces are nearly 0, and their ratio means nothing
FORCE_SCALE_SHARE = 1e-6
TOP_SPEED = "the vehicle's top speed"


def motion_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's motion."""
    yield from starmap(find_largest, _cell_rules(case))
    for findings in (_forces, _jerk, _stops, _windows, _arrival, _speed_limit, _braking_curve):
        yield from findings(case)


def find_disorder(case: Case) -> Check:
    """Return whether places and times rise, and no speed is negative."""
    record, most = case.record, float(np.max(np.abs(case.record.speed_ms)))
    # with an allowance of 0: rounding does not turn the order of places, and all later rules divide by their
    # differences
    back = np.maximum.reduce(
        [
            -np.diff(record.position_m) / max(case.route.length_m, 1.0),
            -np.diff(record.time_s) / max(float(np.ptp(record.time_s)), 1.0),
            -np.minimum(record.speed_ms[:-1], record.speed_ms[1:]) / max(most, 1.0),
        ]
    )
    return find_largest(
        "places, times and speeds rise from zero",
        "the line, the time or the greatest speed",
        0.0,
        back,
        record.position_m[:-1],
    )


def _cell_rules(case: Case) -> Iterator[tuple[str, str, float, FloatArray, FloatArray]]:
    """Yield the rules of places, speeds and times of cells and ends, as arguments of `find_largest`."""
    record, vehicle, length, middle = case.record, case.scenario.vehicle, case.route.length_m, case.middle_m
    ends = record.position_m[[0, -1]]
    yield "whole line driven", "the line", ROUNDING, np.abs(ends - [0.0, length]) / length, ends
    misses = np.abs(record.speed_ms[[0, -1]] - [case.initial_speed_ms, case.final_speed_ms]) / case.top_speed_ms
    yield "speeds at the ends", TOP_SPEED, ROUNDING, misses, ends
    # in a shorter cell forces are nothing but rounding
    share = case.rounding_share
    yield "cells long enough for their places", "the cell, its ends' last digit", ROUNDED_FORCE, share, middle
    misses = np.abs(case.duration_s - case.length_m / case.mean_speed_ms) / np.maximum(case.duration_s, 1.0)
    yield "time of each cell", "the cell's time, at least 1 s", ROUNDING, misses, middle
    for name, change, limit in (
        ("acceleration", case.acceleration_ms2, vehicle.traction.max_acceleration_ms2),
        ("deceleration", -case.acceleration_ms2, vehicle.braking.max_deceleration_ms2),
    ):
        if limit is not None:
            # the rounding is subtracted as an acceleration of its own, as it grows without bound in short cells
            yield name, "the limit", ROUNDED_ACCELERATION, (change - case.rounding_ms2) / limit - 1, middle


def _forces(case: Case) -> Iterator[Finding]:
    """Compare gradients and efforts with those of the line and of the motion."""
    record, weight_kn = case.record, case.train.weight_kn
    if record.gradient_permille is None:
        yield Unchecked("gradient", "the table has no column gradient_permille")
    else:
        difference = np.abs(case.moving(record.gradient_permille) - case.gradient_permille)
        misses = 1e-3 * np.maximum(difference - case.rounding_permille, 0.0)
        yield find_largest("gradient", "the weight", ROUNDED_GRADIENT, misses, case.middle_m)
    if record.effort_n is None:
        yield Unchecked("balance of forces", "the table has no column effort_kn")
        return
    # inertia, running resistance, gradient and curve against the efforts
    reported, required = case.moving(record.effort_n), case.required_effort_n
    # Of the rounding of the speeds only a thousandth: the whole would excuse any force in cells of a millimetre.
    # The efforts of a run are computed from its speeds, so both agree better than either is exact.
    rounding = 1e-3 * case.rounding_n + weight_kn * case.rounding_permille
    misses = np.maximum(np.abs(reported - required) - rounding, 0.0)
    scale = np.maximum(np.abs(reported), np.abs(required)) + FORCE_SCALE_SHARE * N_PER_KN * weight_kn
    yield find_largest("balance of forces", "the force", ROUNDED_FORCE, misses / scale, case.middle_m)


def _jerk(case: Case) -> Iterator[Check]:
    """Compare the rate at which the effort changes, over the inertia, with its limit.

    The effort is constant in a cell, so that the rate is taken between the middles of two; at a stand the acceleration
    is zero.
    """
    limit = case.scenario.vehicle.max_jerk_ms3
    if limit is None or not case.moves.any():
        return
    effort = case.required_effort_n / case.train.inertia_kg
    change, between = np.abs(np.diff(effort)), 0.5 * (case.duration_s[1:] + case.duration_s[:-1])
    # a stand between two cells: each of them begins or ends there without acceleration
    change[case.entering_speed2[1:] == 0] = 0.0
    rate = (change - case.rounding_ms2[1:] - case.rounding_ms2[:-1]) / between
    still = (case.entering_speed2 == 0) | (case.leaving_speed2 == 0)
    ends = np.where(still, 2 * np.abs(case.acceleration_ms2) / case.duration_s, 0.0)
    rates, places = np.append(rate, ends), np.append(case.end_m[:-1], case.middle_m)
    yield find_largest("jerk", "the limit", ROUNDED_JERK, rates / limit - 1, places)


def _stops(case: Case) -> Iterator[Check]:
    """Stand at each station for its dwell, or longer before a window, and nowhere else but before the start."""
    record, passes = case.record, case.route.passes
    at, dwell_s = (np.array([getattr(stop, key) for stop in case.route.stops]) for key in ("position_m", "dwell_s"))
    waits = np.where(case.moves, 0.0, np.diff(record.time_s))
    places = record.position_m[:-1]
    # standing before the start is a late departure and no stop
    waits[places <= places[0]] = 0.0
    here = np.abs(places - at[:, None]) < SAME_PLACE_M
    longer_s = here @ waits - dwell_s
    # before a window the best run may have to wait
    may_wait = record.strategy == "optimal" and bool(_arrival_windows(case))
    misses = (np.maximum(-longer_s, 0.0) if may_wait else np.abs(longer_s)) / np.maximum(dwell_s, 1.0)
    # what is left is standing where no station is
    waits[here.any(axis=0)] = 0.0
    if passes:
        passed_m, speeds = np.array(passes).T
        off = np.abs(_speed_at(case, passed_m) - speeds) / case.top_speed_ms
        yield find_largest("passing speeds", TOP_SPEED, ROUNDING, off, passed_m)
    still = ~case.moves
    before, after = record.speed_ms[:-1][still], record.speed_ms[1:][still]
    # A cell without length is a dwell, at speed 0, or with no time either a node that is written twice, at one speed.
    rolling = np.where(np.diff(record.time_s)[still] > 0, np.maximum(before, after), np.abs(after - before))
    rolling = rolling / case.top_speed_ms
    yield find_largest("stands still where it stands", TOP_SPEED, ROUNDING, rolling, places[still])
    if len(at):
        yield find_largest("stops", TOP_SPEED, ROUNDING, _speed_at(case, at) / case.top_speed_ms, at)
    misses, places = np.append(misses, waits), np.append(at, places)
    yield find_largest("standing times", "the dwell, at least 1 s", ROUNDING, misses, places)


def _windows(case: Case) -> Iterator[Finding]:
    """Compare arrivals at stations with their windows."""
    windows, record = _arrival_windows(case), case.record
    if windows and record.strategy != "optimal":
        # the notes of such a run contain this
        yield Unchecked("windows of arrival", "only the strategy 'optimal' keeps them")
    elif windows:
        places, bounds = np.array(list(windows)), np.array(list(windows.values()))
        # the first of the nodes at a station, at which the train arrives
        first = np.searchsorted(record.position_m, places - SAME_PLACE_M, side="right")
        arrival = record.time_s[np.minimum(first, len(record.time_s) - 1)] - record.time_s[0]
        misses = np.maximum(np.maximum(bounds[:, 0] - arrival, arrival - bounds[:, 1]), 0.0)
        yield find_largest("windows of arrival", "one second", MISSED_S, misses, places)


def _arrival_windows(case: Case) -> dict[float, tuple[float, float]]:
    """Return the windows of arrival by place [m], that of the end of the line among them."""
    windows = {stop.position_m: stop.window_s for stop in case.route.stops}
    windows[float(case.record.position_m[-1])] = case.route.end_window_s
    return {place: window for place, window in windows.items() if window != (0.0, np.inf)}


def _speed_at(case: Case, places_m: FloatArray) -> FloatArray:
    """Return the least speeds at places [m/s]: those of nodes there, or between two."""
    record = case.record
    here = np.abs(record.position_m - places_m[:, None]) < SAME_PLACE_M
    # a mesh of somebody else need not have a node at the station: v^2 is linear between two
    between = np.sqrt(np.interp(places_m, record.position_m, record.speed_ms**2))
    return np.where(here.any(axis=1), np.where(here, record.speed_ms, np.inf).min(axis=1), between)


def _arrival(case: Case) -> Iterator[Finding]:
    record, scenario = case.record, case.scenario
    taken, due = float(record.time_s[-1] - record.time_s[0]), scenario.travel_time_s
    allowed = max(LATE_S / due, LATE_SHARE)
    if reason := _untimed(case):
        yield Unchecked("late arrival", reason)
    else:
        # only this strategy may be late, by a share of the running time: dwells are not driven
        window = scenario.search.time_window if record.strategy == "speed_limits" else 0.0
        latest = due + window * (due - sum(stop.dwell_s for stop in case.route.stops))
        yield find_largest("late arrival", "the timetable's time", allowed, (taken - latest) / due)
    if record.price_of_time_w is None:
        yield Unchecked("early arrival", "no price of time is known, so it may cost nothing")
        return
    lost_j = max(due - taken - allowed * due, 0.0) * record.price_of_time_w
    scale = "the energy moved, by the price of time"
    yield find_largest("early arrival", scale, EARLY_ARRIVAL_COST, lost_j / case.energy_scale_j)


def _untimed(case: Case) -> str:
    """Return why a run keeps no timetable, or nothing."""
    strategy, search = case.record.strategy, case.scenario.search
    if strategy == "fastest":
        return "the fastest run has no timetable to keep"
    if strategy == "speed_limits" and search.limits_kmh is not None:
        return "given limits take the time that they take"
    if strategy == "speed_limits" and search.regulator == "literal":
        return "the printed regulator is not searched with, and promises no time"
    return ""


def _speed_limit(case: Case) -> Iterator[Check]:
    """Compare speeds within cells: between two nodes v^2 is linear, so the greatest is at a border of a limit."""
    record, route = case.record, case.route
    # A comparison at the nodes would miss a limit that begins inside of a cell: a run with nodes of its own need not
    # have one at every border.
    places = np.unique(np.concatenate([record.position_m, route.limit_borders_m]))
    places = places[(places >= record.position_m[0]) & (places <= record.position_m[-1])]
    speed2 = np.interp(places, record.position_m, record.speed_ms**2)
    # a piece that is no longer than rounding belongs to a border that fell beside its node
    whole = np.diff(places) > SAME_PLACE_M
    middle = (0.5 * (places[1:] + places[:-1]))[whole]
    fastest = np.sqrt(np.maximum(speed2[1:], speed2[:-1])[whole])
    limit = np.minimum(route.speed_limit_ms(middle), case.top_speed_ms)
    yield find_largest("speed limit", "the limit", ROUNDED_SPEED, fastest / limit - 1, middle)


def _braking_curve(case: Case) -> Iterator[Check]:
    """Compare braking distances: at each place, that from the speed there with what all targets ahead leave of it.

    With s(v), the distance from v to rest at the decelerations of the curve, a train at x is under the curve that ends
    at X with V where s(v) - s(V) <= X - x. So s(v) + x is held against the least s(V) + X ahead.
    """
    if (steps := case.scenario.vehicle.braking.permitted_deceleration) is None:
        return
    record, route = case.record, case.route
    kmh, deceleration = np.array(steps).T
    step_speed2 = (kmh * MS_PER_KMH) ** 2
    at_steps = np.append(0.0, np.cumsum(np.diff(step_speed2) / (2 * deceleration[:-1])))

    def to_rest_m(speed2: FloatArray) -> FloatArray:
        step = np.searchsorted(step_speed2, speed2, side="right") - 1
        return np.asarray(at_steps[step] + (speed2 - step_speed2[step]) / (2 * deceleration[step]))

    targets, speeds = _curve_ends(case)
    least = np.append(np.minimum.accumulate((to_rest_m(speeds**2) + targets)[::-1])[::-1], np.inf)
    corners, corner_speed2 = _corners_of_distance(case, step_speed2)
    places = np.concatenate([corners, record.position_m, route.limit_borders_m])
    # a limit may begin within a cell of a run that has nodes of its own
    at_borders = np.interp(route.limit_borders_m, record.position_m, record.speed_ms**2)
    speed2 = np.concatenate([corner_speed2, record.speed_ms**2, at_borders])
    distance = to_rest_m(speed2)
    # rounding of a place must not put a train that stands at its stop before or behind it
    excess = distance + places - least[np.searchsorted(targets, places - SAME_PLACE_M)]
    share = excess / np.maximum(distance, 1.0)
    yield find_largest("braking curve", "the braking distance, at least 1 m", ROUNDED_CURVE, share, places)


def _curve_ends(case: Case) -> tuple[FloatArray, FloatArray]:
    """Return the places [m], rising, at which braking curves end, and the speeds there [m/s]."""
    route = case.route
    borders = route.limit_borders_m[route.limit_borders_m <= route.length_m]
    limits = np.minimum(route.speed_limit_ms(0.5 * (borders[1:] + borders[:-1])), case.top_speed_ms)
    ends = [
        # at a border the lower of its two limits holds; where a limit rises, the lower one holds before it anyway
        *zip(borders, np.minimum(np.append(limits[0], limits), np.append(limits, limits[-1])), strict=True),
        *((stop.position_m, 0.0) for stop in route.stops),
        *route.passes,
        (route.length_m, case.final_speed_ms),
    ]
    places, speeds = np.array(sorted(ends)).T
    return places, speeds


def _corners_of_distance(case: Case, step_speed2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the places [m] within cells, and squares of speed, at which the deceleration of the curve steps."""
    before, after, steps = case.entering_speed2, case.leaving_speed2, step_speed2[1:, None]
    step, cell = np.nonzero((before - steps) * (after - steps) < 0)
    speed2 = step_speed2[1:][step]
    share = (speed2 - before[cell]) / (after - before)[cell]
    return case.start_m[cell] + share * case.length_m[cell], speed2
