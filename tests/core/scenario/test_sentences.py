"""Bad input: one clear sentence each, that names key, value and bound."""

import math

import pytest
from builders import HILLS, PLAIN, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.errors import RailjouleError, ScenarioError
from railjoule.core.scenario import Line, Scenario, Vehicle, scenario_from_document
from railjoule.core.scenario._sentences import show, suggestion

CASES = {
    "not a number": ({"vehicle.tare_kg": math.nan}, "vehicle.tare_kg = nan must be a finite number."),
    "infinite": ({"timetable.travel_time_s": math.inf}, "timetable.travel_time_s = inf must be a finite number."),
    "negative mass": ({"vehicle.tare_kg": -1.0}, "vehicle.tare_kg = -1 must be above 0."),
    "negative load": ({"vehicle.load_factor": -0.1}, "vehicle.load_factor = -0.1 must be at least 0."),
    "too much load": (
        {"vehicle.load_factor": 1.5},
        "vehicle.load_factor = 1.5 must be at most 1, the crush_load_factor.",
    ),
    "no time": ({"timetable.travel_time_s": 0}, "timetable.travel_time_s = 0 must be above 0."),
    "more than a day": ({"timetable.travel_time_s": 86401}, "timetable.travel_time_s = 86401 must be at most 86400."),
    "text for a number": ({"vehicle.tare_kg": "100"}, "vehicle.tare_kg = '100' must be a number."),
    "truth for a number": ({"vehicle.tare_kg": True}, "vehicle.tare_kg = True must be a number."),
    "number for a truth": ({"line.reverse": 1}, "line.reverse = 1 must be true or false."),
    "number for a text": ({"title": 5}, "title = 5 must be a text."),
    "number for a list": ({"line.sections": 5}, "line.sections = 5 must be a list."),
    "table for a list": ({"line.sections": {"a": 1}}, "line.sections = {'a': 1} must be a list."),
    "part of a car": (
        {"vehicle.length_m": 50.0, "vehicle.car_count": 2.5},
        "vehicle.car_count = 2.5 must be a whole number.",
    ),
    "huge whole number": (
        {"vehicle.length_m": 50.0, "vehicle.car_count": 10**30},
        "vehicle.car_count = 1000000000000000000000000000000 must be at most 200.",
    ),
    "whole number beyond floats": ({"vehicle.tare_kg": 10**400}, "vehicle.tare_kg = 10000"),
    "whole number beyond writing": (
        {"vehicle.tare_kg": 16**6000},
        "vehicle.tare_kg = a number of very many digits must be a number.",
    ),
    "unknown key": ({"vehicle.load_facter": 1}, "unknown key vehicle.load_facter, did you mean 'load_factor'?"),
    "unknown key in a part": (
        {"vehicle.braking.friction_efort_kn": 1},
        "unknown key vehicle.braking.friction_efort_kn, did you mean 'friction_effort_kn'",
    ),
    "unknown key unlike any": ({"zzz": 1}, "unknown key zzz, choose one of disturbance, enoc, eoc, line, montecarlo, "),
    "unknown key of a drive": (
        {"drive.efficiency": 0.9},
        "unknown key drive.efficiency, did you mean 'braking_efficiency' or 'traction_efficiency'?",
    ),
    "very long key": ({"x" * 5000: 1}, "unknown key " + "x" * 57 + "..., choose one of "),
    "misspelt key of a section": (
        {"line.sections": [{"length": 5}]},
        "unknown key line.sections[0].length, did you mean 'length_m'? (and 1 more).",
    ),
    "second section": (
        {"line.sections": [{"length_m": 5}, {"length_m": -5}]},
        "line.sections[1].length_m = -5 must be above 0.",
    ),
    "section without length": ({"line.sections": [{}]}, "line.sections[0].length_m is missing."),
    "no sections": ({"line.sections": []}, "line.sections is empty."),
    "line of no length": (
        {"line.sections": [{"length_m": 1e-7}]},
        "line is 1e-07 m long, and must be at least 1 m.",
    ),
    "limit beyond the line": (
        {"line.speed_limits": [{"from_m": 0, "to_m": 3000, "limit_kmh": 5}]},
        "line.speed_limits[0].to_m = 3000 lies beyond the end of the line at 2000 m.",
    ),
    "limit of no length": (
        {"line.speed_limits": [{"from_m": 50, "to_m": 50, "limit_kmh": 5}]},
        "line.speed_limits[0].to_m = 50 is not beyond from_m = 50.",
    ),
    "station beyond the line": (
        {"line.stations": [{"position_m": 10}, {"position_m": 2001}]},
        "line.stations[1].position_m = 2001 lies beyond the end of the line at 2000 m.",
    ),
    "stations out of order": (
        {"line.stations": [{"position_m": 900}, {"position_m": 100}]},
        "line.stations must have rising positions with distances of at least 1 m.",
    ),
    "two stations in one place": (
        {"line.stations": [{"position_m": 900}, {"position_m": 900.5}]},
        "line.stations must have rising positions with distances of at least 1 m.",
    ),
    "unknown strategy": ({"strategy": "best"}, "strategy = 'best' must be 'optimal', 'bellman', 'eoc'"),
    "unknown distribution": (
        {"montecarlo.load_factor": {"distribution": "magic"}},
        "montecarlo.load_factor.distribution = 'magic' must be one of 'fixed', 'uniform', ",
    ),
    "distribution in disorder": (
        {"montecarlo.load_factor": {"distribution": "uniform", "low": 1.0, "high": 0.5}},
        "montecarlo.load_factor.high = 0.5 must be above low = 1",
    ),
    "negative deviation": (
        {"montecarlo.load_factor": {"distribution": "normal", "standard_deviation": -1.0}},
        "montecarlo.load_factor.standard_deviation = -1 must be above 0",
    ),
    "unknown drive": ({"drive.model": "magic"}, "drive.model = 'magic' must be one of 'constant_efficiency', "),
    "curve that falls back": (
        {"vehicle.traction.curve": [[0, 100], [50, 80], [40, 60]]},
        "vehicle.traction.curve must have rising speeds; two points at the same speed are a step.",
    ),
    "curve of three columns": (
        {"vehicle.traction.curve": [[0, 100, 1], [50, 80]]},
        "vehicle.traction.curve[0] has more than 2 entries.",
    ),
    "curve of no effort": (
        {"vehicle.traction.curve": [[0, 0], [50, 0]]},
        "vehicle.traction.curve must have an effort above 0.",
    ),
    "brake that falls back": (
        {"vehicle.braking.curve": [[0, 100], [50, 80], [40, 60]]},
        "vehicle.braking.curve must have rising speeds; two points at the same speed are a step.",
    ),
    "brake of no effort": (
        {"vehicle.braking.curve": [[0, 0], [50, 0]]},
        "vehicle.braking.curve must have an effort above 0.",
    ),
    "breakdown of nothing": (
        {"vehicle.braking": {"breakdown_speed_kmh": 60}},
        "vehicle.braking.breakdown_speed_kmh needs max_effort_kn, max_power_kw or curve.",
    ),
    "braking curve that begins in motion": (
        {"vehicle.braking.permitted_deceleration": [[5, 0.7]]},
        "vehicle.braking.permitted_deceleration begins at 5 km/h, but must begin at 0.",
    ),
    "braking curve that falls back": (
        {"vehicle.braking.permitted_deceleration": [[0, 0.7], [50, 0.6], [40, 0.5]]},
        "vehicle.braking.permitted_deceleration must have rising speeds.",
    ),
    "braking curve that never stops": (
        {"vehicle.braking.permitted_deceleration": [[0, 0.7], [50, 0]]},
        "vehicle.braking.permitted_deceleration[1][1] = 0 must be above 0.",
    ),
    "braking curve of nothing": (
        {"vehicle.braking.permitted_deceleration": []},
        "vehicle.braking.permitted_deceleration is empty.",
    ),
    "braking curve of too many steps": (
        {"vehicle.braking.permitted_deceleration": [[k, 0.7] for k in range(101)]},
        "vehicle.braking.permitted_deceleration has more than 100 entries.",
    ),
    "cars without a length": ({"vehicle.car_count": 3}, "vehicle.car_count needs length_m."),
    "inertia below the mass": (
        {"vehicle.inertial_mass_kg": 5e4},
        "vehicle.inertial_mass_kg = 50000 is below tare_kg = 100000, which it includes.",
    ),
    "too fine a mesh": ({"solver.mesh_m": 1e-300}, "solver.mesh_m = 1e-300 must be at least 0.001."),
}


@pytest.mark.parametrize("case", CASES)
def test_sentence(case):
    change, sentence = CASES[case]
    with pytest.raises(ScenarioError) as error:
        plain_scenario(change)
    assert str(error.value).startswith("scenario: ")
    assert sentence in str(error.value)
    assert str(error.value).endswith((".", "?"))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("table", ["vehicle", "line", "timetable"])
def test_missing_table(table):
    with pytest.raises(ScenarioError, match=f"^scenario: {table} is missing.$"):
        scenario_from_document({key: value for key, value in PLAIN.items() if key != table})


@pytest.mark.parametrize("times", [{}, {"travel_time_s": 100.0, "average_speed_kmh": 40.0}])
def test_needs_one_time(times):
    with pytest.raises(ScenarioError, match="timetable needs exactly one of travel_time_s, average_speed_kmh,"):
        scenario_from_document({**PLAIN, "timetable": times})


@pytest.mark.parametrize("inertia", [{}, {"rotating_mass_factor": 0.1, "inertial_mass_kg": 2e5}])
def test_needs_one_inertia(inertia):
    vehicle = {key: value for key, value in PLAIN["vehicle"].items() if key != "rotating_mass_factor"}
    with pytest.raises(ScenarioError, match="vehicle needs exactly one of rotating_mass_factor and inertial_mass_kg"):
        scenario_from_document({**PLAIN, "vehicle": {**vehicle, **inertia}})


def test_drive_without_model():
    with pytest.raises(ScenarioError, match=r"drive.model is missing"):
        scenario_from_document({**PLAIN, "vehicle": {**PLAIN["vehicle"], "drive": {}}})


junk = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
paths = st.sampled_from(
    [
        f"{table}.{name}" if table else name
        for table, model in (("", Scenario), ("vehicle", Vehicle), ("line", Line))
        for name in model.model_fields
    ]
    + ["drive", "drive.model", "vehicle.traction.curve", "line.sections", "line.file", "vehicle.preset", "line.preset"]
)


@given(path=paths, value=junk)
def test_junk_makes_a_scenario_or_one_sentence(path, value):
    sentence = ""
    try:
        plain_scenario({"line.sections": HILLS, path: value})
    except RailjouleError as error:
        sentence = str(error)
    # any other exception fails here
    assert "\n" not in sentence


def test_nearest_names_come_first():
    assert suggestion("max_efort_kn", ["max_effort_kn", "max_power_kw", "name"]).startswith(
        "did you mean 'max_effort_kn'"
    )
    assert suggestion("zzz", ["b", "a"]) == "choose one of a, b"


def test_values_are_shown_short():
    assert show(0.1) == "0.1"
    assert show("x" * 100) == "'" + "x" * 56 + "..."
    assert len(show(list(range(1000)))) == 60


@pytest.mark.parametrize("sign", ["\u202e", "\u2066", "\u200f", "\x00", "\x1b", "\n", "\u2028"])
@pytest.mark.parametrize("key", ["title", "vehicle.name", "line.name"])
def test_a_sign_that_misleads_is_refused_in_any_name(key, sign):
    with pytest.raises(ScenarioError) as refusal:
        plain_scenario({key: f"Tram {sign}1"})
    assert f"{key} has the sign U+{ord(sign):04X}, which is no text" in str(refusal.value)


def test_names_of_all_scripts_are_taken():
    # Arabic, Hebrew and Devanagari letters, a joiner within an emoji, an accent of its own
    name = "\u0642\u0637\u0627\u0631 \u05e8\u05db\u05d1\u05ea \u0930\u0947\u0932 \U0001f469\u200d\U0001f527 e\u0301"
    assert plain_scenario({"title": name}).title == name
