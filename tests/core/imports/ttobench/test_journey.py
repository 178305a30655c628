import json
import re
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.ttobench.journey import read_service
from railjoule.core.scenario import Station

KEEPS_WINDOWS = "earliest_arrival_s" in Station.model_fields
FILE = Path(__file__).parents[1] / "files" / "ttobench-journey.json"


def service_of(*values, stops="all"):
    journey = json.loads(FILE.read_text())
    journey["timing points"]["values"] = values
    return read_service(SourceFile("j.json", json.dumps(journey).encode()), stops)


def test_a_journey_gives_time_and_stops():
    """Dwell from the latest arrival, 150 s, to the earliest departure, 180 s."""
    service = read_service(SourceFile.read(FILE))
    assert (service.begin_m, service.end_m) == (0, 5000)
    assert service.stops == ({"position_m": 2000, "dwell_s": 30, "earliest_arrival_s": 120, "latest_arrival_s": 150},)
    assert service.timetable == {"travel_time_s": 360}
    name = "ttobench-journey.json"
    assert service.unused == (
        f"{name}: the time from 60 to 90 s and the speed from 20 km/h at 1,000 m.",
        f"{name}: {'' if KEEPS_WINDOWS else 'the arrival from 120 to 150 s and '}the departure from 180 to 200 s at "
        "2,000 m.",
    )
    assert [finding.sentence for finding in service.findings] == [
        f"{name}: arrives from 330 to 360 s: the latest is taken."
    ]


def test_stops_may_be_left_out():
    service = read_service(SourceFile.read(FILE), "ends")
    assert service.stops == ()
    assert "ttobench-journey.json: the stop at 2,000 m." in service.unused


def test_a_stop_at_one_point_has_no_dwell():
    service = service_of([0, 0, 0, 0, 0], [500, 50, 60, 0, 0], [900, 100, 100, 0, 0])
    assert service.stops == ({"position_m": 500, "earliest_arrival_s": 50, "latest_arrival_s": 60},)
    assert service.unused == (() if KEEPS_WINDOWS else ("j.json: the arrival from 50 to 60 s at 500 m.",))


def test_arrivals_count_from_the_departure():
    service = service_of([0, 100, 120, 0, 0], [500, 150, None, 0, 0], [900, 200, 300, 0, 0])
    assert (service.stops, service.timetable) == (
        ({"position_m": 500, "earliest_arrival_s": 50},),
        {"travel_time_s": 200},
    )


def test_speeds_at_the_ends():
    service = service_of([0, 0, 0, 30, 30], [900, 80, 80, None, 60])
    assert service.timetable == {"travel_time_s": 80, "entry_speed_kmh": 30}
    assert [finding.sentence for finding in service.findings] == ["j.json: the speed at the end is free: 0 km/h."]


def test_a_journey_need_not_say_when_it_ends():
    assert service_of([0, 0, 0, 0, 0], [900, None, None, 0, 0]).timetable == {}


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (
            ([0, 0, 0, 0, 0], [900, 90, 80, 0, 0]),
            "j.json: timing points.values[1]: the least time 90 is above the largest 80.",
        ),
        (
            ([500, 0, 0, 0, 0], [100, 90, 90, 0, 0]),
            "j.json: timing points.values[1]: position = 100 lies before 500.",
        ),
        (([0, 0, 0, 0], [900, 90, 90, 0, 0]), "j.json: timing points.values[0][4] is missing."),
        (([0, 0, 0, 0, 0],), "j.json: timing points.values has fewer than 2 entries."),
    ],
)
def test_bad_journeys_are_refused_in_one_sentence(values, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        service_of(*values)
