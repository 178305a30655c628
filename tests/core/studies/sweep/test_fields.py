import math

import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.studies.sweep.fields import corners_hold, parse_fields, patched
from tests.builders import COPPER_LOSS, plain_scenario


@pytest.mark.parametrize(
    "changes",
    [
        {"vehicle.load_factor": 0.3, "timetable.travel_time_s": 140.0},
        {"drive.recuperation_factor": 0.7, "vehicle.resistance.constant_n": 12.0},
        # one key replaces another that says the same thing
        {"timetable.average_speed_kmh": 40.0, "vehicle.inertial_mass_kg": 2e5},
        {"drive.motors": 6, "vehicle.length_m": 80.0},
    ],
)
@pytest.mark.parametrize("base", [plain_scenario({"vehicle.drive": COPPER_LOSS}), load_scenario("ftorek-300s")])
def test_a_patched_scenario_is_that_of_with(base, changes):
    fields = parse_fields(base, {name: (value, value) for name, value in changes.items()})
    made = patched(base, fields, list(map(float, changes.values())))
    assert made == base.replace(**changes)
    # what no field touches is shared, so that whoever keeps it may compare by identity
    assert made.line is base.line


def test_corners_tell_whether_all_within_is_a_scenario():
    base = plain_scenario()
    assert corners_hold(base, parse_fields(base, {"vehicle.load_factor": (0.0, 1.0), "vehicle.tare_kg": (9e4, 1e5)}))
    crowded = base.replace(**{"vehicle.crush_load_factor": 1.2})
    over = {"vehicle.load_factor": (0.0, 1.2), "vehicle.crush_load_factor": (1.0, 1.2)}
    assert not corners_hold(crowded, parse_fields(crowded, over))


@pytest.mark.parametrize(
    ("over", "words"),
    [
        ({}, "a sweep varies 1 to 10 fields, not 0"),
        ({"vehicle.loadfactor": (0, 1)}, r"unknown key vehicle.loadfactor, did you mean .*'load_factor'"),
        ({"train.load_factor": (0, 1)}, "unknown key train.load_factor, choose one of"),
        ({"drve.recuperation_factor": (0, 1)}, "unknown key drve.recuperation_factor, did you mean 'drive'"),
        ({"vehicle.name": (0, 1)}, "vehicle.name is no number"),
        ({"line.reverse": (0, 1)}, "line.reverse is no number"),
        ({"line.sections": (0, 1)}, "line.sections is no number"),
        ({"vehicle": (0, 1)}, "vehicle is no number"),
        ({"vehicle.name.length": (0, 1)}, "name is no table with numbers"),
        ({"vehicle.load_factor": (0.0, 1.5)}, r"load_factor = 1.5 must be at most 1, the crush_load_factor"),
        ({"vehicle.load_factor": (-0.5, 1.0)}, "vehicle.load_factor = -0.5 must be at least 0"),
        ({"vehicle.load_factor": (0.8, 0.2)}, "vehicle.load_factor: the range 0.8 to 0.2 begins above its end"),
        ({"vehicle.load_factor": (math.nan, 0.2)}, "nan is no end of a range"),
        ({"vehicle.load_factor": (0.0, math.inf)}, "inf is no end of a range"),
        ({"vehicle.load_factor": ("0", 1.0)}, "'0' is no end of a range"),
        ({"drive.motors": (1.5, 4)}, "drive.motors: the ends of the range 1.5 to 4 must be whole numbers"),
        (
            {"timetable.travel_time_s": (140, 150), "timetable.average_speed_kmh": (30, 40)},
            "timetable.travel_time_s and timetable.average_speed_kmh say the same thing",
        ),
        (
            {"drive.recuperation_factor": (0, 1), "vehicle.drive.recuperation_factor": (0, 1)},
            "drive.recuperation_factor and vehicle.drive.recuperation_factor say the same thing",
        ),
    ],
)
def test_a_bad_range_is_refused_in_a_sentence(over, words):
    with pytest.raises(ScenarioError, match=words):
        parse_fields(plain_scenario({"vehicle.drive": COPPER_LOSS}), over)
