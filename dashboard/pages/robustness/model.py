"""What the page Robustness asks for: the reality that a plan meets, the table, and what chance draws."""

from collections.abc import Mapping
from typing import Any, get_args

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.options import TARGET_BRAKING_KEYS, MonteCarloOptions, SimulationOptions
from railjoule.core.studies.braking_sensors import BrakingSensors
from railjoule.core.studies.robust_plan import CANDIDATES, MAX_CANDIDATES, PROBABILITY
from railjoule.core.studies.sensitivity_table import Knows
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.actual.follower import FOLLOWER, REALITY, SENSOR_ERRORS, SENSOR_FIELDS
from railjoule.dashboard.pages.robustness.compute import Reality, RobustAnswer
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, TypedParameters, core_bounds
from railjoule.dashboard.state.page_model import PageModel, result

SENSORS = SimulationOptions()
CHANCE = MonteCarloOptions()
FIRST_LOAD_PERCENT, FIRST_ERROR_M = 100.0, 10.0
"""The reality shown at first, where the scenario names none: one in which something goes wrong."""
PREVIEW_RUNS, FULL_RUNS = 500, 10_000
ROBUST_RUNS = 1500
"""Draws of the check of a robust plan; its candidates have a fifth of them."""
CHANCE_FIELDS = (
    "load_deviation_percent",
    "error_deviation_m",
    "resistance_deviation_percent",
    "voltage_deviation_percent",
    "speed_deviation_percent",
    "sensor_deviation_m",
    "mean_departure_delay_s",
    "seed",
)
"""The draws of the Monte Carlo study."""
ROBUST_FIELDS = ("probability_percent", "accepted_delay_s", "candidates")
"""The search for a robust plan."""
TABLE_FIELDS = ("both_directions", "knows")
# beyond any distance of a sensor from its stop a mistake, which the file would take
MAX_SENSOR_ERROR_M = 1000.0
MEASURES = ("over_replanned", "overconsumption", "delay_s", "stop_error_m")


def sensor_error(name: str) -> TypedNumber:
    """Return the error of the place of a sensor."""
    return TypedNumber(f"{name} place error, m", "m", 1, default=0.0, bounds=(-MAX_SENSOR_ERROR_M, MAX_SENSOR_ERROR_M))


def sensor(label: str, unit: str, digits: int, key: str) -> TypedNumber:
    """Return a number of the sensors, with default and bounds of its key in the file."""
    default, bounds = getattr(SENSORS, key), core_bounds(SimulationOptions, key)
    return TypedNumber(label, unit, digits, default=default, **bounds)


class RobustnessModel(TypedParameters, PageModel):
    """The settings of the page and its results, in the units that it shows."""

    kept = (*REALITY, *FOLLOWER, *CHANCE_FIELDS, *ROBUST_FIELDS, *TABLE_FIELDS, "measure")
    passing = ("drawing", "searching", "most_load_percent")

    actual_load_percent = TypedNumber(
        "Actual load, % of capacity",
        "%",
        default=FIRST_LOAD_PERCENT,
        step=1,
        **core_bounds(Disturbance, "actual_load_factor", 100),
    )
    coordinate_error_m = TypedNumber(
        "Position error, m",
        "m",
        default=FIRST_ERROR_M,
        softbounds=(-25, 25),
        step=1,
        **core_bounds(Disturbance, "coordinate_error_m"),
    )
    speed_error_percent = TypedNumber(
        "Speed error, %",
        "%",
        1,
        default=0.0,
        softbounds=(-5, 5),
        step=0.1,
        **core_bounds(SimulationOptions, "speed_error", 100),
    )
    target_braking = param.Boolean(
        default=SENSORS.target_braking, doc="Whether the train brakes along the target curve."
    )
    reset_sensor_m = sensor("D1, resets position", "m", 0, "reset_sensor_m")
    calibration_length_m = sensor("D1 to D2, calibrates", "m", 0, "calibration_length_m")
    stop_sensor_m = sensor("D3, resets position", "m", 0, "stop_sensor_m")
    target_deceleration_ms2 = sensor("Target curve, m/s\u00b2", "m/s\u00b2", 2, "target_deceleration_ms2")
    d1_error_m, d2_error_m, d3_error_m = map(sensor_error, ("D1", "D2", "D3"))
    load_deviation_percent = TypedNumber("Load, \u00b1 %", "%", default=18.0, bounds=(0.01, 100))
    error_deviation_m = TypedNumber("Position error, \u00b1 m", "m", 1, default=5.0, bounds=(0.01, 1000))
    resistance_deviation_percent = TypedNumber("Resistance, \u00b1 %", "%", 1, default=8.0, bounds=(0.01, 100))
    voltage_deviation_percent = TypedNumber("Supply voltage, \u00b1 %", "%", 1, default=3.0, bounds=(0.01, 50))
    speed_deviation_percent = TypedNumber("Speed error, \u00b1 %", "%", 2, default=0.5, bounds=(0.01, 10))
    sensor_deviation_m = TypedNumber("Sensor places, \u00b1 m", "m", 1, default=0.5, bounds=(0.01, 100))
    mean_departure_delay_s = TypedNumber("Departure delay, mean, s", "s", default=0.0, bounds=(0, 3600))
    seed = TypedInteger("Seed", default=CHANCE.seed, bounds=(0, 2**31))
    probability_percent = TypedNumber("Probability, %", "%", default=100 * PROBABILITY, bounds=(1, 99.9))
    accepted_delay_s = TypedNumber(
        "Accepted lateness, s", "s", 1, default=0.0, **core_bounds(Disturbance, "accepted_delay_s")
    )
    candidates = TypedInteger("Candidate plans", default=CANDIDATES, bounds=(1, MAX_CANDIDATES))
    both_directions = param.Boolean(default=False, doc="Whether the table covers both directions.")
    knows = param.Selector(default="nothing", objects=list(get_args(Knows)), doc="What the train knows.")
    measure = param.Selector(default="over_replanned", objects=list(MEASURES), doc="What the table shows.")

    reality = result(Reality, "The last good run.")
    table = result(StudyTable, "The table so far.")
    chance = result(StudyTable, "Random runs so far.")
    most_load_percent = param.Number(default=100.0, doc="The vehicle's crush load, % of capacity.")
    drawing = param.Boolean(default=False, doc="Whether Monte Carlo runs are being drawn.")
    stops = result(BrakingSensors, "Stopping errors with precision braking and without.")
    robust = result(RobustAnswer, "The robust plan, or the search for it so far.")
    searching = param.Boolean(default=False, doc="Whether a robust plan is being searched.")
    find_robust = param.Event(doc="Search the robust plan.")
    stop_search = param.Event(doc="Stop the search for a robust plan.")
    draw_all = param.Event(doc="Draw all Monte Carlo runs.")
    stop_drawing = param.Event(doc="Stop drawing; the runs so far are kept.")

    def take(self, scenario: Scenario) -> None:
        """Take over what a scenario's file says of reality."""
        disturbance, simulation = scenario.disturbance, scenario.simulation
        named = disturbance.actual_load_factor is not None or disturbance.coordinate_error_m != 0
        load = disturbance.actual_load_factor
        load_percent = 100 * (scenario.vehicle.load_factor if load is None else load)
        self.param.update(
            actual_load_percent=load_percent if named else FIRST_LOAD_PERCENT,
            coordinate_error_m=disturbance.coordinate_error_m if named else FIRST_ERROR_M,
            speed_error_percent=100 * simulation.speed_error,
            target_braking=simulation.target_braking,
            target_deceleration_ms2=simulation.target_deceleration_ms2,
            accepted_delay_s=disturbance.accepted_delay_s,
            **dict(zip(SENSOR_ERRORS, simulation.sensor_errors_m, strict=True)),
            **{
                name: getattr(simulation, name)
                for name in ("reset_sensor_m", "calibration_length_m", "stop_sensor_m")
                if getattr(simulation, name) is not None
            },
        )

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives for a field; the load has the bound of the vehicle."""
        number = super().parse(field, text)
        if field == "actual_load_percent" and number > self.most_load_percent:
            raise ValueError(f"At most {self.most_load_percent:g}, the vehicle's crush load.")
        return number

    @property
    def changes(self) -> Mapping[str, Any]:
        """The reality and the sensors, by the keys of the file."""
        sensors: dict[str, Any] = dict.fromkeys(f"simulation.{key}" for key in TARGET_BRAKING_KEYS)
        if self.target_braking:
            sensors = {f"simulation.{key}": float(getattr(self, key)) for key in SENSOR_FIELDS}
            sensors["simulation.sensor_errors_m"] = tuple(float(getattr(self, name)) for name in SENSOR_ERRORS)
        return {
            "disturbance.actual_load_factor": self.actual_load_percent / 100,
            "disturbance.coordinate_error_m": float(self.coordinate_error_m),
            "simulation.speed_error": self.speed_error_percent / 100,
            "simulation.target_braking": self.target_braking,
            **sensors,
        }

    def robust_changes(self, runs: int) -> Mapping[str, Any]:
        """Return what the search for a robust plan changes in a scenario, by the keys of the file."""
        return {**self.chance_changes(runs), "disturbance.accepted_delay_s": float(self.accepted_delay_s)}

    def chance_changes(self, runs: int) -> Mapping[str, Any]:
        """Return the distributions, by the keys of the file: normal, but for resistance and departure."""

        def normal(deviation: float) -> dict[str, Any]:
            return {"distribution": "normal", "standard_deviation": deviation}

        resistance = {
            "distribution": "log_normal",
            "median": 1.0,
            "log_standard_deviation": self.resistance_deviation_percent / 100,
        }
        late = self.mean_departure_delay_s
        departure = {"distribution": "exponential", "mean": late} if late else {"distribution": "fixed", "value": 0.0}
        return {
            **self.changes,
            "montecarlo.runs": runs,
            "montecarlo.seed": self.seed,
            "montecarlo.load_factor": normal(self.load_deviation_percent / 100),
            "montecarlo.coordinate_error_m": normal(float(self.error_deviation_m)),
            "montecarlo.resistance_factor": resistance,
            "montecarlo.line_voltage_factor": normal(self.voltage_deviation_percent / 100),
            "montecarlo.departure_delay_s": departure,
            "montecarlo.speed_error": normal(self.speed_deviation_percent / 100),
            **{f"montecarlo.{name}": normal(float(self.sensor_deviation_m)) for name in SENSOR_ERRORS},
        }
