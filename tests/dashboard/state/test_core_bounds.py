"""Each number that a field takes, the scenario's file takes too (dashboard.md, D6: 5 of 8 fields of Robustness)."""

from typing import Annotated, Any

import pytest
from pydantic import BaseModel, TypeAdapter

from railjoule.core.scenario.disturbance import (
    Disturbance,
    Event,
    Exponential,
    LogNormal,
    Normal,
    RecuperationChange,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.core.scenario.drive import InductionMachine
from railjoule.core.scenario.line import Station
from railjoule.core.scenario.options import EnocOptions, MonteCarloOptions, SearchOptions, SimulationOptions
from railjoule.core.scenario.scenario import Timetable
from railjoule.core.scenario.vehicle import Vehicle
from railjoule.dashboard.day import Day, EventModel
from railjoule.dashboard.pages.files.page import Files
from railjoule.dashboard.pages.line.model import StationModel
from railjoule.dashboard.pages.line.page import WholeLines
from railjoule.dashboard.pages.motor.page import Motor
from railjoule.dashboard.pages.set_speeds.page import SetSpeeds
from railjoule.dashboard.pages.set_speeds.sections import SectionModel
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.scenario import ScenarioModel
from railjoule.dashboard.workbench import Workbench

STOP, LIMIT = EventModel(kind="stop"), EventModel(kind="limit")
VOLTAGE, RECUPERATION = EventModel(kind="voltage"), EventModel(kind="recuperation")
DAY = Day(ScenarioModel())
Key = tuple[type[BaseModel], str, float]
KEYS: dict[str, tuple[TypedParameters, dict[str, Key]]] = {
    "day": (
        DAY,
        {
            "actual_load_percent": (Disturbance, "actual_load_factor", 100),
            "coordinate_error_m": (Disturbance, "coordinate_error_m", 1),
            "speed_error_percent": (SimulationOptions, "speed_error", 100),
            "reset_sensor_m": (SimulationOptions, "reset_sensor_m", 1),
            "calibration_length_m": (SimulationOptions, "calibration_length_m", 1),
            "stop_sensor_m": (SimulationOptions, "stop_sensor_m", 1),
            "target_deceleration_ms2": (SimulationOptions, "target_deceleration_ms2", 1),
            "load_deviation_percent": (Normal, "standard_deviation", 100),
            "error_deviation_m": (Normal, "standard_deviation", 1),
            "resistance_deviation_percent": (LogNormal, "log_standard_deviation", 100),
            "voltage_deviation_percent": (Normal, "standard_deviation", 100),
            "speed_deviation_percent": (Normal, "standard_deviation", 100),
            "sensor_deviation_m": (Normal, "standard_deviation", 1),
            "seed": (MonteCarloOptions, "seed", 1),
            "accepted_delay_s": (Disturbance, "accepted_delay_s", 1),
        },
    ),
    "stop": (
        STOP,
        {
            "position_m": (UnplannedStop, "position_m", 1),
            "duration_s": (UnplannedStop, "duration_s", 1),
            "noticed_at_m": (Event, "noticed_at_m", 1),
        },
    ),
    "limit": (
        LIMIT,
        {
            "position_m": (UnplannedLimit, "from_m", 1),
            "to_m": (UnplannedLimit, "to_m", 1),
            "limit_kmh": (UnplannedLimit, "limit_kmh", 1),
        },
    ),
    "voltage": (VOLTAGE, {"share_percent": (VoltageChange, "line_voltage_factor", 100)}),
    "recuperation": (RECUPERATION, {"share_percent": (RecuperationChange, "recuperation_factor", 100)}),
    "what if": (
        Workbench().pages["What if"],
        {"accepted_lateness_s": (Disturbance, "accepted_delay_s", 1)},
    ),
    "motor": (
        Motor(Workbench()),
        {
            "bandwidth_rads": (SimulationOptions, "bandwidth_rads", 1),
            "rotor_resistance_factor": (SimulationOptions, "rotor_resistance_factor", 1),
            "speed_noise_rads": (SimulationOptions, "speed_noise_rads", 1),
            "noise_seed": (SimulationOptions, "noise_seed", 1),
            "max_phase_voltage_v": (InductionMachine, "max_phase_voltage_v", 1),
            "max_current_a": (InductionMachine, "max_current_a", 1),
        },
    ),
    "speed limits": (
        SetSpeeds(Workbench()),
        {
            "time_window_percent": (SearchOptions, "time_window", 100),
            "stop_deceleration_ms2": (SearchOptions, "stop_deceleration_ms2", 1),
        },
    ),
    "section": (SectionModel(), {}),
    "station": (
        StationModel(),
        {
            "dwell_s": (Station, "dwell_s", 1),
            "earliest_s": (Station, "earliest_arrival_s", 1),
            "latest_s": (Station, "latest_arrival_s", 1),
            "given_s": (Station, "arrival_s", 1),
        },
    ),
    "line": (WholeLines(Workbench()), {}),
    "files": (Files(Workbench()), {}),
    "explore": (Workbench().pages["Explore"], {}),
    "scenario": (
        ScenarioModel(),
        {
            "travel_time_s": (Timetable, "travel_time_s", 1),
            "load_percent": (Vehicle, "load_factor", 100),
            "load_t": (Vehicle, "load_t", 1),
            "acceleration_time_s": (EnocOptions, "acceleration_time_s", 1),
        },
    ),
}
"""Of each model, the keys of the file that its fields set, and how many of a field's units are one of the key's."""
NO_SINGLE_KEY = {
    # 0 stands for no delay at all; above it is the mean of `Exponential`
    "mean_departure_delay_s",
    # of an event of another kind
    *("position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m"),
    # what the page shows, which no file has
    "ripple_at_s",
    "cruise_speed_kmh",
    "begins_at_m",
    *("storage_size_kwh", "storage_power_kw", "charging_percent", "discharging_percent"),
    # an entry of a list of the file, held to the vehicle's speed, and how many there are
    *("section_count", "to_m"),
    *("d1_error_m", "d2_error_m", "d3_error_m"),
    # of a study, not of its scenario
    *("runs", "seed", "probability_percent", "candidates"),
    # a drive's, whichever it is
    "recuperation_percent",
}


def ends(model: TypedParameters, field: str) -> list[float]:
    """Return the least and the largest number that a field takes."""
    (low, high), (low_in, high_in) = model.bounds_of(field), model.closed_ends(field)
    # just inside of an end that it does not take itself
    low = low if low is None or low_in else low + 1e-9
    high = high if high is None or high_in else high - 1e-9
    return [end for end in (low, high) if end is not None]


@pytest.mark.parametrize(("page", "field"), [(page, field) for page, (_, keys) in KEYS.items() for field in keys])
def test_what_a_field_takes_the_file_takes(page: str, field: str) -> None:
    model, keys = KEYS[page]
    part, key, scale = keys[field]
    declared: Any = part.model_fields[key]
    adapter = TypeAdapter(Annotated[declared.annotation, *declared.metadata])
    found = ends(model, field)
    assert len(found) == 2
    for number in found:
        adapter.validate_python(int(number) if key.endswith("seed") else number / scale)


def test_every_field_of_every_page_is_held_to_the_file() -> None:
    for page, (model, keys) in KEYS.items():
        typed = {name for name in model.param if isinstance(model.param[name], TypedNumber)}
        assert typed <= {*keys, *NO_SINGLE_KEY}, page


@pytest.mark.parametrize(
    ("model", "field", "text", "sentence"),
    [
        (DAY, "reset_sensor_m", "0", "Above 0."),
        (DAY, "calibration_length_m", "0", "Above 0."),
        (DAY, "stop_sensor_m", "0", "Above 0."),
        (DAY, "target_deceleration_ms2", "0", "Above 0."),
        (DAY, "speed_error_percent", "50", "Below 50."),
        (DAY, "speed_error_percent", "-50", "Above -50."),
        (SetSpeeds(Workbench()), "time_window_percent", "0", "Above 0."),
        (SetSpeeds(Workbench()), "stop_deceleration_ms2", "0", "Above 0."),
        (SetSpeeds(Workbench()), "storage_size_kwh", "-1", "At least 0."),
        (STOP, "position_m", "0", "Above 0."),
        (LIMIT, "limit_kmh", "0", "Above 0."),
        (VOLTAGE, "share_percent", "0", "Above 0."),
        (RECUPERATION, "share_percent", "150", "At most 100."),
    ],
)
def test_what_the_file_refuses_the_field_refuses(model: TypedParameters, field: str, text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        model.parse(field, text)
    # and a link too
    with pytest.raises(ValueError, match=sentence.split(" ", maxsplit=1)[0].lower()):
        model.checked(field, float(text))


def test_a_link_is_held_to_the_kind_of_its_events() -> None:
    for kind, share in (("recuperation", 150.0), ("voltage", 0.0)):
        with pytest.raises(ValueError, match="share_percent"):
            DAY.checked("events", [{"share_percent": share, "kind": kind}])
    # a limit may begin where the line does
    assert DAY.checked("events", [{"kind": "limit", "position_m": 0.0}])


def test_the_mean_delay_is_one_that_the_file_takes() -> None:
    model = Day(ScenarioModel(), mean_departure_delay_s=ends(DAY, "mean_departure_delay_s")[1])
    Exponential.model_validate(model.chance_changes(1)["montecarlo.departure_delay_s"])
