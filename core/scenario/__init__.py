"""Scenarios: vehicle, line, timetable and disturbances as frozen, validated values and as files."""

from railjoule.core.scenario.document import (
    as_scenario,
    format_scenario,
    load_scenario,
    parse_scenario,
    save_scenario,
    scenario_from_document,
    to_document,
)
from railjoule.core.scenario.line import Line, NeutralSection, Section, SpeedLimit, Station
from railjoule.core.scenario.presets import preset_document, preset_names, preset_text, scenario_of_vehicle
from railjoule.core.scenario.resistance import Resistance
from railjoule.core.scenario.scenario import Scenario, Timetable
from railjoule.core.scenario.vehicle import Braking, Traction, Vehicle

__all__ = [
    "Braking",
    "Line",
    "NeutralSection",
    "Resistance",
    "Scenario",
    "Section",
    "SpeedLimit",
    "Station",
    "Timetable",
    "Traction",
    "Vehicle",
    "as_scenario",
    "format_scenario",
    "load_scenario",
    "parse_scenario",
    "preset_document",
    "preset_names",
    "preset_text",
    "save_scenario",
    "scenario_from_document",
    "scenario_of_vehicle",
    "to_document",
]
