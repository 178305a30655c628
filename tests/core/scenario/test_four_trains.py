"""Vehicles from public data: balancing speeds, times from a stand, shortest times and assumptions, by own formulas."""

from collections.abc import Callable

import numpy as np
import pytest

from railjoule.core import Scenario, TimetableError, Vehicle, load_scenario, solve
from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import preset_document, preset_names, scenario_of_vehicle
from railjoule.core.strategies import prepare_task
from railjoule.core.studies import assumption_effects

G = 9.81
TRAINS = ("regional-flirt", "light-rail-sd160", "high-speed-velaro", "freight-vectron")
PER_TONNE = {"regional-flirt": 122, "light-rail-sd160": 40.37, "high-speed-velaro": 425, "freight-vectron": 1103}


def train(name: str) -> tuple[float, float, Callable, Callable, float]:
    """Return mass and inertia [kg], resistance and effort over speed [N, m/s], and the largest acceleration.

    Read from the file's numbers, by formulas of this module.
    """
    file = preset_document("vehicles", name)
    mass, terms, limits = file["tare_kg"] + 1000 * file.get("max_load_t", 0), file["resistance"], file["traction"]
    weight_kn = mass * G / 1e3

    def resistance(speed):
        kmh = 3.6 * speed
        specific = (terms.get(f"{power}_n_per_kn{unit}", 0.0) for power, unit in POWERS)
        absolute = (terms.get(f"{power}_n{unit}", 0.0) for power, unit in POWERS)
        return sum((weight_kn * s + a) * kmh**k for k, (s, a) in enumerate(zip(specific, absolute, strict=True)))

    def effort(speed):
        return np.minimum(1e3 * limits["max_effort_kn"], 1e3 * limits["max_power_kw"] / np.maximum(speed, 1e-9))

    inertia = mass * (1 + file["rotating_mass_factor"])
    return mass, inertia, resistance, effort, limits.get("max_acceleration_ms2", np.inf)


POWERS = (("constant", ""), ("linear", "_per_kmh"), ("quadratic", "_per_kmh2"))


def from_stand(name: str, to_kmh: float) -> tuple[float, float]:
    """Integrate time and distance over speed, on the level."""
    _, inertia, resistance, effort, most = train(name)
    speed = np.linspace(0, to_kmh / 3.6, 200_001)
    mean = (speed[1:] + speed[:-1]) / 2
    times = np.diff(speed) / np.minimum((effort(mean) - resistance(mean)) / inertia, most)
    return float(times.sum()), float((times * mean).sum())


def shortest_s(name: str, length_m: float, limit_kmh: float, gradient: float) -> float:
    """Pass forward and backward over a line of one gradient in steps of 0.25 m."""
    mass, inertia, resistance, effort, most = train(name)
    brake = preset_document("vehicles", name)["braking"]["max_deceleration_ms2"]
    steps = round(length_m / 0.25)
    forward, backward, slope = np.zeros(steps + 1), np.zeros(steps + 1), mass * G * gradient / 1e3
    top = (limit_kmh / 3.6) ** 2
    for k in range(steps):
        speed = np.sqrt(forward[k])
        # by the mean speed of the step, in two rounds
        for _ in range(2):
            rate = min((effort(speed) - resistance(speed) - slope) / inertia, most)
            speed = (np.sqrt(forward[k]) + np.sqrt(max(forward[k] + 0.5 * rate, 0))) / 2
        forward[k + 1] = min(forward[k] + 0.5 * rate, top)
        backward[k + 1] = min(backward[k] + 0.5 * brake, top)
    square = np.minimum(forward, backward[::-1])
    speed = np.sqrt(square)
    return float((0.5 / (speed[1:] + speed[:-1])).sum())


def on_one_section(name: str, **line) -> Scenario:
    section = {"length_m": line.get("length_m", 4000.0), "gradient_permille": line.get("gradient", 0.0)}
    if "limit_kmh" in line:
        section["speed_limit_kmh"] = line["limit_kmh"]
    # passengers get off; the freight of the other train is part of it
    empty = {} if "max_load_t" in preset_document("vehicles", name) else {"vehicle.load_factor": 0.0}
    return load_scenario(name).replace(
        {"line": {"sections": [section]}, "timetable": {"travel_time_s": 9000.0}, **empty}
    )


@pytest.mark.parametrize(
    ("name", "to_kmh"),
    [("regional-flirt", 100), ("light-rail-sd160", 60), ("high-speed-velaro", 200), ("freight-vectron", 80)],
)
def test_time_and_distance_from_a_stand(name, to_kmh):
    time_s, way_m = from_stand(name, to_kmh)
    run = solve(on_one_section(name, length_m=1.5 * way_m + 9000), strategy="fastest")
    index = int(np.searchsorted(run.speed_ms, to_kmh / 3.6))
    share = (to_kmh / 3.6 - run.speed_ms[index - 1]) / (run.speed_ms[index] - run.speed_ms[index - 1])
    reached = [
        float(values[index - 1] + share * (values[index] - values[index - 1]))
        for values in (run.time_s, run.position_m)
    ]
    assert reached == pytest.approx([time_s, way_m], rel=2e-3)


@pytest.mark.parametrize("gradient", [0.0, 15.0])
@pytest.mark.parametrize("name", TRAINS)
def test_balancing_speed(name, gradient):
    """At the speed at which effort and resistance are equal, by bisection, our resistance is the effort."""
    mass, _, resistance, effort, _ = train(name)
    low, high = 1.0, 300.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if effort(middle) > resistance(middle) + mass * G * gradient / 1e3 else (low, middle)
    constant, linear, quadratic = resistance_coefficients(Vehicle.from_preset(name))
    held = constant + linear * low + quadratic * low**2 + mass * G * gradient / 1e3
    assert held == pytest.approx(float(effort(low)), rel=1e-6)
    known = {
        ("regional-flirt", 0.0): 254.2, ("light-rail-sd160", 0.0): 185.3, ("high-speed-velaro", 0.0): 369.1,
        ("freight-vectron", 0.0): 147.6,
    }  # fmt: skip
    if (name, gradient) in known:
        assert 3.6 * low == pytest.approx(known[name, gradient], abs=0.1)


@pytest.mark.parametrize(
    ("name", "length_m", "limit_kmh", "gradient"),
    [
        ("regional-flirt", 3000.0, 120.0, 8.0),
        ("light-rail-sd160", 900.0, 60.0, 20.0),
        ("high-speed-velaro", 12_000.0, 230.0, 0.0),
        ("freight-vectron", 5000.0, 80.0, 4.0),
    ],
)
def test_shortest_time_on_one_gradient(name, length_m, limit_kmh, gradient):
    scenario = on_one_section(name, length_m=length_m, limit_kmh=limit_kmh, gradient=gradient)
    own = shortest_s(name, length_m, limit_kmh, gradient)
    assert prepare_task(scenario).shortest_travel_time_s == pytest.approx(own, rel=2e-3)


def test_published_numbers():
    """Each with how far off we are: the sources stand in assets/docs/reference/presets.md."""
    # Velaro E, 0 to 320 km/h in 380 s: 335 s empty, so 12 % less
    assert from_stand("high-speed-velaro", 320)[0] == pytest.approx(380, rel=0.15)
    # Helsinki's FLIRT: some 6 kWh/km; 4.1 as proven optimum, 6.9 as the fastest run
    flirt = load_scenario("regional-flirt")
    best, fastest = (solve(flirt, strategy=one).energy_kwh / 24.0 for one in ("optimal", "fastest"))
    assert best < 6.0 < fastest
    # mixed freight trains in Finland, 1016 t of wagons: 14 kWh/km
    freight = load_scenario("freight-vectron")
    level = freight.replace({"line": {"sections": [{"length_m": 40_000.0}]}, "timetable": {"average_speed_kmh": 60.0}})
    assert solve(level).energy_kwh / 40 == pytest.approx(14, rel=0.15)
    # Madrid-Valencia, 391 km at up to 300 km/h: 13.83 kWh/km net
    assert solve(load_scenario("high-speed-velaro")).energy_kwh / 120 == pytest.approx(13.83, rel=0.25)


@pytest.mark.parametrize("name", TRAINS)
def test_all_that_a_file_assumes_is_listed_in_it(name):
    vehicle = Vehicle.from_preset(name)
    assert vehicle.assumptions == vehicle.assumed
    assert {"drive.recuperation_factor", "vehicle.auxiliary_power_kw"} <= {one.key for one in vehicle.assumed}


def test_every_shipped_vehicle_has_a_scenario():
    for name in preset_names("vehicles"):
        assert load_scenario(scenario_of_vehicle(name)).vehicle.preset == name


def test_another_train_on_a_tram_line_gets_the_shortest_time():
    with pytest.raises(TimetableError, match="shortest"):
        solve(
            load_scenario("tram-950m").replace({"vehicle": {"preset": "freight-vectron"}, "drive": None}),
            strategy="optimal",
        )


def test_effects_of_assumptions_are_those_of_single_runs():
    scenario = load_scenario("light-rail-sd160")
    table = assumption_effects(scenario)
    label = "vehicle.auxiliary_power_kw"
    row = list(table.assumption).index(label)
    other = solve(scenario.replace({label: 0.8 * 20})).energy_kwh
    assert table["lower_value_kwh"][row] == pytest.approx(other, rel=1e-6)
    # 4 kW for 640 s are 0.711 kWh, whatever the run
    assert table.energy_kwh - other == pytest.approx(4 * 640 / 3600, rel=1e-4)
    largest = np.nanmax(np.abs([table["lower_value_difference"], table["higher_value_difference"]]), axis=0)
    assert np.all(np.diff(largest) <= 1e-12)
    factor = list(table.assumption).index("drive.recuperation_factor")
    assert np.isnan(table["higher_value_kwh"][factor])
    assert "at most 1" in table.reasons[factor]
