"""Random scenarios over the whole format: every drive, stations, brakes, tunnels, curves, cars, tight timetables.

Lines are short and meshes coarse, so that every strategy can drive some hundreds of them within a minute.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.errors import InfeasibleLineError
from railjoule.core.scenario import preset_document, scenario_from_document
from railjoule.core.strategies import Task, prepare_task
from tests.builders import INDUCTION, LOSS_POLYNOMIAL

MODELS = ("constant_efficiency", "copper_loss", "loss_polynomial", "efficiency_map", "induction", "synchronous")
MOST_TIME_S = 20_000
MAX_CELLS = 60
SPREAD = 0.2
"""By how much the numbers of a motor vary, as a share."""

Table = dict[str, Any]


@dataclass(frozen=True)
class _Train:
    """What the parts of a scenario have to fit to: effort [N], speed [m/s] and power [W]."""

    mass_kg: float
    effort_n: float
    speed_ms: float
    power_w: float


def any_document(seed: int) -> Table:
    """Return the scenario of a seed as a nested dictionary; one seed after another has one drive after another."""
    rng = np.random.default_rng(seed)
    tare = float(10 ** rng.uniform(4.0, 5.6))
    effort, speed = tare * rng.uniform(0.5, 1.4), rng.uniform(30, 160) / 3.6
    train = _Train(tare, effort, speed, effort * speed * rng.uniform(0.25, 0.8))
    model = MODELS[seed % len(MODELS)]
    # two strategies take copper loss on plain lines alone
    line = _line(rng, rng.random() < (0.6 if model == "copper_loss" else 0.25), speed)
    length = sum(section["length_m"] for section in line["sections"])
    document = {
        "title": f"any {seed}",
        "vehicle": _vehicle(rng, train, model),
        "line": line,
        "timetable": {"travel_time_s": 86_400.0},
        "solver": {"mesh_m": max(float(rng.uniform(5, 40)), length / MAX_CELLS)},
        "search": {"regulator": str(rng.choice(["coast", "coast", "brake", "literal"]))},
    }
    # the search for limits takes most of the time, and no less for more of them
    document["search"]["boundaries_m"] = [length * float(rng.uniform(0.3, 0.7))]
    return document


def any_full_document(seed: int) -> Table:
    """Return the scenario of a seed with what came later: neutral sections, and what train protection permits.

    It draws from numbers of its own, so that the scenarios that tests know by their seed stay as they are.
    """
    rng, document = np.random.default_rng([seed, 2]), any_document(seed)
    _add_braking(rng, document["vehicle"])
    line = document["line"]
    length = sum(section["length_m"] for section in line["sections"])
    # on a plain line EOC and ENOC are tried, which refuse all of these
    if len(line["sections"]) > 1 and rng.random() < 0.3:
        start = rng.uniform(0.1, 0.8) * length
        line["neutral_sections"] = [{"from_m": start, "to_m": start + rng.uniform(0.01, 0.1) * length}]
    if len(line["sections"]) > 1 and rng.random() < 0.2:
        line["head_wind_kmh"] = rng.uniform(0, 80)
    if "length_m" in document["vehicle"] and rng.random() < 0.5:
        line["limits_hold_for"] = "whole_train"
    return document


def any_wide_document(seed: int) -> Table:
    """Return the scenario of a seed over all that a file may ask of the core, but for windows of arrival.

    Beside `any_full_document`: speeds at the ends, several stations, passing points, meshes from fine to wide, curves
    that end at no effort, long times on or off, strong auxiliaries, and where gradients act on a long train.
    """
    rng, document = np.random.default_rng([seed, 3]), any_full_document(seed)
    line, vehicle, top = document["line"], document["vehicle"], document["vehicle"]["traction"]["max_speed_kmh"]
    length = sum(section["length_m"] for section in line["sections"])
    document["solver"]["mesh_m"] = float(max(10 ** rng.uniform(0.3, 1.9), length / MAX_CELLS))
    if MODELS[seed % len(MODELS)] in MODELS[2:] and rng.random() < 0.4:
        vehicle["drive"]["least_switching_s"] = float(rng.choice([0.0, rng.uniform(0, 15)]))
    if rng.random() < 0.2:
        vehicle["auxiliary_power_kw"] = vehicle["tare_kg"] / 1e3 * rng.uniform(0.5, 3)
    if "length_m" in vehicle and rng.random() < 0.3:
        vehicle["gradient_at"] = str(rng.choice(["front", "middle"]))
    if rng.random() < 0.08 and "max_effort_kn" in vehicle["traction"]:
        effort = vehicle["traction"]["max_effort_kn"]
        vehicle["traction"]["curve"] = [[0.0, effort], [rng.uniform(0.2, 0.8) * top, 0.4 * effort], [top, 0.0]]
    # eoc and enoc are tried on plain lines only, and refuse all of these
    if len(line["sections"]) == 1:
        return document
    for key in ("entry_speed_kmh", "exit_speed_kmh"):
        if rng.random() < 0.2:
            document["timetable"][key] = rng.uniform(0.05, 0.6) * top
    if rng.random() < 0.45:
        places = (np.arange(int(rng.integers(1, 5))) + rng.uniform(0.4, 1.4)) * length / 5.5
        line["stations"] = [{"position_m": float(x), "dwell_s": float(rng.choice([0.0, 15.0]))} for x in places]
    if rng.random() < 0.12:
        point = {"position_m": rng.uniform(0.1, 0.9) * length, "speed_kmh": rng.uniform(0.1, 0.5) * top}
        if all(abs(point["position_m"] - place["position_m"]) > 5 for place in line.get("stations", ())):
            line["passing_points"] = [point]
    return document


def any_placed_document(seed: int) -> Table:
    """Return the scenario of a seed as `any_wide_document`, half of them with limits by place or that begin early."""
    rng, document = np.random.default_rng([seed, 6]), any_wide_document(seed)
    line, vehicle = document["line"], document["vehicle"]
    length = sum(section["length_m"] for section in line["sections"])
    # eoc and enoc are tried on plain lines only, and refuse all of these
    if len(line["sections"]) == 1 or rng.random() < 0.4:
        return document
    effort_kn, top = vehicle["tare_kg"] / 1e3 * 0.8, vehicle["traction"]["max_speed_kmh"]

    def stretch() -> Table:
        start = rng.uniform(0.0, 0.8) * length
        return {"from_m": start, "to_m": start + rng.uniform(0.05, 1.0) * (length - start)}

    limits = []
    for _ in range(int(rng.integers(0, 4))):
        limit = stretch()
        kind = int(rng.integers(5))
        if kind == 0:
            limit["max_effort_kn"] = effort_kn * rng.uniform(0.4, 1.2)
        if kind == 1:
            limit["max_power_kw"] = effort_kn * top / 3.6 * rng.uniform(0.15, 0.7)
        if kind in (2, 3):
            limit["effort_factor"] = rng.uniform(0.4, 1.0)
        if kind in (3, 4):
            limit["recuperation_factor"] = float(rng.choice([0.0, rng.uniform(0, 1)]))
        limits.append(limit)
    if limits:
        line["traction_limits"] = limits
    if rng.random() < 0.3:
        line["limit_margin_m"] = rng.uniform(1, 100)
    if rng.random() < 0.3:
        vehicle["adhesion"] = {"driven_mass_share": rng.uniform(0.5, 1.0)}
        line["rail_conditions"] = [stretch() | {"condition": str(rng.choice(["dry", "wet"]))}]
        if rng.random() < 0.5:
            line["rail_condition"] = "dry"
    if limits and rng.random() < 0.3:
        vehicle["line_voltage_v"] = 750.0
        power_w = 1e3 * effort_kn * top / 3.6 * rng.uniform(0.3, 1.0) + 1e3 * vehicle.get("auxiliary_power_kw", 0.0)
        limits.append(stretch() | {"max_current_a": power_w / 750.0})
    return document


def any_placed_task(seed: int) -> Task | None:
    """Return the task of `any_placed_document` with a timetable that can be kept; None if no run passes its line."""
    document = any_placed_document(seed)
    try:
        task = prepare_task(scenario_from_document(document))
    except InfeasibleLineError:
        return None
    document["timetable"]["travel_time_s"] = task.shortest_time_s * any_time(seed) + task.dwell_s
    return prepare_task(scenario_from_document(document))


def add_windows(document: Table, seed: int, arrivals_s: dict[float, float], slack_s: float) -> None:
    """Add windows of arrival to some stations, and to the terminus of some lines, that a train which can wait keeps.

    Parameters
    ----------
    document : dict
        The scenario.
    seed : int
    arrivals_s : dict of float to float
        Arrival of the fastest run at each place of `line.stations`, and at the end of the run [s].
    slack_s : float
        Time of the timetable beyond that run's [s].
    """
    rng, line = np.random.default_rng([seed, 4]), document["line"]
    terminus = 0.0 if line.get("reverse") else sum(section["length_m"] for section in line["sections"])
    stations = {station["position_m"]: station for station in line.get("stations", ())}
    if rng.random() < 0.06:
        stations.setdefault(terminus, {"position_m": terminus})
    places = sorted((place for place in stations if place in arrivals_s), key=lambda place: arrivals_s[place])
    if not places or rng.random() < 0.4:
        return
    # later arrivals have no less of the slack used up, so that all windows can be kept together
    for place, used in zip(places, np.sort(rng.uniform(0, 1, len(places))).tolist(), strict=True):
        kind, width = int(rng.integers(5)), rng.uniform(0, 0.3) * slack_s
        arrival = arrivals_s[place] + used * slack_s
        if kind in (1, 3):
            stations[place]["earliest_arrival_s"] = max(arrival - width * rng.uniform(0, 1), 0.0)
        if kind in (2, 3):
            stations[place]["latest_arrival_s"] = arrival + width * rng.uniform(0, 1)
        if kind == 4:
            stations[place] |= {"earliest_arrival_s": arrival, "latest_arrival_s": arrival}
    line["stations"] = [stations[place] for place in sorted(stations)]


def _add_braking(rng: np.random.Generator, vehicle: Table) -> None:
    """Add a braking curve, an effort over speed and a breakdown to some."""
    braking, top = vehicle["braking"], vehicle["traction"]["max_speed_kmh"]
    if rng.random() < 0.2:
        braking["permitted_deceleration"] = [[0.0, rng.uniform(0.2, 1.0)]]
        if rng.random() < 0.5:
            braking["permitted_deceleration"].append([rng.uniform(0.3, 0.9) * top, rng.uniform(0.2, 1.0)])
    if rng.random() < 0.15 and braking["max_effort_kn"]:
        effort = braking["max_effort_kn"]
        braking["curve"] = [[0.0, 0.5 * effort], [0.1 * top, effort], [top, 0.4 * effort]]
    for side in (braking, vehicle["traction"]):
        if rng.random() < 0.15 and side.get("max_effort_kn"):
            side["breakdown_speed_kmh"] = rng.uniform(0.4, 1.0) * top


def any_time(seed: int) -> float:
    """Return the time of the scenario of a seed over the shortest one, without dwells: from all but none to much."""
    rng = np.random.default_rng([seed, 1])
    return float(rng.choice([1.002, rng.uniform(1.01, 1.1), rng.uniform(1.1, 1.6), rng.uniform(1.6, 4)]))


def any_task(seed: int) -> Task | None:
    """Return the task of a seed, with a timetable that can be kept; None if no run passes its line."""
    document = any_document(seed)
    try:
        task = prepare_task(scenario_from_document(document))
    except InfeasibleLineError:
        return None
    total = task.shortest_time_s * any_time(seed) + task.dwell_s
    if total > MOST_TIME_S:
        return None
    document["timetable"]["travel_time_s"] = total
    return prepare_task(scenario_from_document(document))


def _vehicle(rng: np.random.Generator, train: _Train, model: str) -> Table:
    vehicle: Table = {
        "name": "any",
        "tare_kg": train.mass_kg,
        "capacity_passengers": int(train.mass_kg / 200),
        "load_factor": float(rng.choice([0.0, 0.5, 1.0])),
        "resistance": _resistance(rng),
        "traction": _traction(rng, train, model),
        "braking": _braking(rng, train),
        "drive": _drive(rng, train, model),
    }
    if rng.random() < 0.7:
        vehicle["rotating_mass_factor"] = rng.uniform(0, 0.3)
    else:
        vehicle["inertial_mass_kg"] = train.mass_kg * rng.uniform(1, 1.3)
    if rng.random() < 0.5:
        vehicle["auxiliary_power_kw"] = train.mass_kg / 1e3 * rng.uniform(0, 0.5)
    if rng.random() < 0.4:
        vehicle["length_m"] = rng.uniform(10, 120)
        if rng.random() < 0.6:
            cars = vehicle["car_count"] = int(rng.integers(1, 6))
            if cars > 1 and rng.random() < 0.5:
                kinds = [{"cars": 1, "constant_n_per_kn": 1.0}, {"cars": cars - 1, "linear_n_per_kn_per_kmh": 0.005}]
                vehicle["resistance"]["car_kinds"] = kinds
    return vehicle


def _resistance(rng: np.random.Generator) -> Table:
    resistance = {"constant_n_per_kn": rng.uniform(0.8, 3.5), "curve_constant_m_n_per_kn": rng.uniform(400, 800)}
    if rng.random() < 0.5:
        resistance["linear_n_per_kn_per_kmh"] = rng.uniform(0, 0.03)
    if rng.random() < 0.8:
        resistance["quadratic_n_per_kn_per_kmh2"] = rng.uniform(1e-4, 1e-3)
    if rng.random() < 0.2:
        resistance |= {"constant_n": rng.uniform(0, 500), "linear_n_per_kmh": 3.0, "quadratic_n_per_kmh2": 0.2}
    return resistance


def _traction(rng: np.random.Generator, train: _Train, model: str) -> Table:
    top, effort = train.speed_ms * 3.6, train.effort_n / 1e3
    traction: Table = {"max_speed_kmh": top}
    # some motors have limits of their own
    if model in MODELS[:3] or rng.random() < 0.5:
        traction["max_effort_kn"] = effort
    if rng.random() < 0.7:
        traction["max_power_kw"] = train.power_w / 1e3
    if rng.random() < 0.15:
        traction["curve"] = [[0.0, effort], [0.4 * top, 0.9 * effort], [top, 0.3 * effort]]
    if rng.random() < 0.2:
        traction["max_acceleration_ms2"] = rng.uniform(0.3, 1.2)
    return traction


def _braking(rng: np.random.Generator, train: _Train) -> Table:
    braking: Table = {
        "max_effort_kn": train.mass_kg / 1e3 * float(rng.choice([0.0, rng.uniform(0.3, 1.3)], p=[0.05, 0.95]))
    }
    if rng.random() < 0.4:
        braking["max_power_kw"] = train.power_w / 1e3 * rng.uniform(0.5, 1.5)
    if rng.random() < 0.5 or not braking["max_effort_kn"]:
        braking["friction_effort_kn"] = train.mass_kg / 1e3 * rng.uniform(0.1, 1.2)
    if rng.random() < 0.2:
        braking["max_deceleration_ms2"] = rng.uniform(0.4, 1.3)
    return braking


def _drive(rng: np.random.Generator, train: _Train, model: str) -> Table:
    """Return a drive for a train, from one of known numbers where there is one."""
    recuperation = float(rng.choice([0.0, 1.0, rng.uniform()]))
    if model == "constant_efficiency":
        drive = {"traction_efficiency": rng.uniform(0.6, 1.0)}
        if rng.random() < 0.5:
            drive["braking_efficiency"] = rng.uniform(0.4, 1.0)
    elif model == "copper_loss":
        drive = {"motors": 4, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "torque_per_amp_nm": 5.0}
        amperes = train.effort_n / (4 * 5.0 * 12.5)
        drive["resistance_ohm"] = rng.uniform(0.02, 0.25) * train.power_w / (4 * amperes**2)
    elif model == "loss_polynomial":
        drive = _varied(rng, LOSS_POLYNOMIAL, ("no_load_loss_w", "speed_loss_w_per_rads2", "torque_loss_w_per_nm2"))
        drive["motors"] = _motors(train, 6000)
    elif model == "efficiency_map":
        drive = _map(rng, train)
    elif model == "induction":
        keys = ("stator_resistance_ohm", "rotor_resistance_ohm", "mechanical_loss_torque_nm", "max_phase_voltage_v")
        drive = _varied(rng, INDUCTION, keys) | {"motors": _motors(train, 5500 * rng.uniform(0.7, 2))}
        drive["standstill_brake"] = bool(rng.random() < 0.5)
    else:
        known = preset_document("vehicles", "metro-5-car-synchronous")["drive"]
        drive = _varied(rng, known, ("magnet_flux_vs", "stator_resistance_ohm", "hysteresis_loss_w", "max_current_a"))
        drive["motors"] = _motors(train, 20_000 * rng.uniform(0.7, 2))
        # the motors turn no faster than they may
        drive["gear_ratio"] = min(drive["gear_ratio"], 0.5 * drive["wheel_diameter_m"] * 330 / train.speed_ms)
        drive["modulation"] = str(rng.choice(["six_step", "space_vector"]))
    return drive | {"model": model, "recuperation_factor": recuperation}


def _motors(train: _Train, effort_n: float) -> int:
    """Return how many motors of an effort [N] pull a train."""
    return max(round(train.effort_n / effort_n), 1)


def _varied(rng: np.random.Generator, drive: Table, keys: tuple[str, ...]) -> Table:
    return drive | {key: float(drive[key] * rng.uniform(1 - SPREAD, 1 + SPREAD)) for key in keys}


def _map(rng: np.random.Generator, train: _Train) -> Table:
    """Return a map of efficiencies of two motors that lose something at rest, by speed and by torque."""
    turns, share = 12.5, float(rng.choice([0.0, 0.03]))
    max_nm, most_rads = 1.02 * train.effort_n * (1 + share) / (2 * turns), 1.01 * train.speed_ms * turns
    power = train.power_w / 2
    torques = np.linspace(0, max_nm, int(rng.integers(3, 9)))
    if rng.random() < 0.5:
        torques = np.concatenate([-torques[:0:-1], torques])
    points = []
    for torque in torques.tolist():
        for speed in np.linspace(0, most_rads, 7).tolist():
            loss = power * (0.004 + 0.02 * (speed / most_rads) ** 2 + 0.05 * (torque / max_nm) ** 2)
            shaft = abs(torque) * speed
            efficiency = shaft / (shaft + loss) if torque >= 0 else max(1 - loss / max(shaft, 1e-9), 0.0)
            points.append([torque, speed, round(efficiency, 6)])
    geared = {"motors": 2, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "gear_loss_share": share}
    return {"points": points, **geared}


def _line(rng: np.random.Generator, plain: bool, speed_ms: float) -> Table:
    length = float(10 ** rng.uniform(2.2, 3.4))
    if plain:
        return {"sections": [{"length_m": length, "gradient_permille": float(rng.choice([0.0, rng.uniform(-8, 8)]))}]}
    count = int(rng.integers(1, 6))
    shares = rng.dirichlet(np.ones(count)) * 0.9 + 0.1 / count
    line: Table = {"sections": [_section(rng, float(share * length), speed_ms) for share in shares]}
    line["reverse"] = bool(rng.random() < 0.4)
    if rng.random() < 0.3:
        start = rng.uniform(0, 0.8) * length
        end = min(start + float(rng.choice([0.5, 0.2 * length])), length)
        line["speed_limits"] = [{"from_m": start, "to_m": end, "limit_kmh": 3.6 * speed_ms * rng.uniform(0.3, 0.9)}]
    if rng.random() < 0.4:
        places = np.linspace(0, length, int(rng.integers(1, 3)) + 2)[1:-1] * rng.uniform(0.8, 1.1)
        line["stations"] = [{"position_m": float(place), "dwell_s": float(rng.choice([0.0, 20.0]))} for place in places]
    return line


def _section(rng: np.random.Generator, length: float, speed_ms: float) -> Table:
    section = {"length_m": length, "gradient_permille": float(rng.uniform(-25, 25) if rng.random() < 0.8 else 0.0)}
    if rng.random() < 0.2:
        section["speed_limit_kmh"] = 3.6 * speed_ms * rng.uniform(0.3, 1.0)
    if rng.random() < 0.2:
        section["curve_radius_m"] = rng.uniform(150, 2000)
    if rng.random() < 0.15:
        section["tunnel_factor"] = rng.uniform(1.0, 3.0)
    return section
