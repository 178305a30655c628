import json
import re
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.ttobench import read_track
from railjoule.core.imports.ttobench.train import TunnelCoefficients

FILE = Path(__file__).parents[1] / "files" / "ttobench-track.json"
TRACK = json.loads(FILE.read_text())
COEFFICIENTS = TunnelCoefficients((20.0, 40.0), (1.5, 0.5), 1.0)


def track_of(stops="all", **changes):
    """Read the example with other entries; None leaves one out."""
    track = {**TRACK, **{key.replace("_", " "): value for key, value in changes.items()}}
    content = json.dumps({key: value for key, value in track.items() if value is not None})
    return read_track(SourceFile("track.json", content.encode()), stops=stops)


def steps(values, **units):
    return {"units": {"position": "m", **units}, "values": values}


def test_a_track_becomes_a_line():
    """Transitions have their mean curvature: from straight to 500 m 1/1000, from 500 to -500 m too."""
    line = read_track(SourceFile.read(FILE), COEFFICIENTS)
    rows = [
        (s.length_m, s.gradient_permille, s.speed_limit_kmh, s.curve_radius_m, s.tunnel_factor)
        for s in line.line.sections
    ]
    assert rows == [
        (1000, 5, 80, 0, 1),
        (1500, -3.5, 80, 0, 1),
        (500, -3.5, 120, 0, 1),
        (100, -3.5, 120, 1000, 1),
        (200, -3.5, 120, 500, 1),
        (100, -3.5, 120, 1000, 1),
        (600, -3.5, 120, 0, 1),
        (500, -3.5, 120, 0, 2),
        (500, -3.5, 120, 0, 1),
    ]
    assert line.document["line"]["stations"] == [{"position_m": 2000}]
    assert line.unused == ("ttobench-track.json: altitude.",)
    assert [finding.sentence for finding in line.findings] == [
        "ttobench-track.json: 2 transitions between radii: taken at their mean curvature.",
        "ttobench-track.json: its stops have no dwell times: 0 s.",
    ]


def test_stops_between_the_ends_may_be_left_out():
    line = track_of(stops="ends")
    assert line.line.stations == ()
    assert "track.json: stops between the ends, at 2,000 m." in line.unused


def test_a_track_begins_at_its_first_stop():
    track = {**TRACK, "stops": {"unit": "m", "values": [500.0, 4500.0]}}
    line = read_track(SourceFile("track.json", json.dumps(track).encode()))
    assert (line.begin_m, line.line.length_m) == (500, 4000)
    assert line.line.sections[0].length_m == 500


@pytest.mark.parametrize("coefficients", [None, TunnelCoefficients((35.0, 40.0), (1.5, 0.5), 1.0)])
def test_a_tunnel_of_which_the_train_knows_nothing_is_told(coefficients):
    line = read_track(SourceFile.read(FILE), coefficients)
    assert {section.tunnel_factor for section in line.line.sections} == {1.0}
    assert [(one.from_m, one.to_m, one.value) for one in line.tunnels] == [(4000, 4500, 30)]
    assert any("tunnels without a factor on quadratic resistance: 4,000 to 4,500 m" in told for told in line.unused)


def test_only_stops_and_limits_must_be_there():
    line = read_track(
        SourceFile("t", json.dumps({key: TRACK[key] for key in ("metadata", "stops", "speed limits")}).encode())
    )
    assert [(s.length_m, s.speed_limit_kmh) for s in line.line.sections] == [(2500, 80), (2500, 120)]


def test_a_gradient_that_begins_late_is_told():
    line = track_of(gradients=steps([[100, 5]], slope="permil"))
    gaps = [finding.sentence for finding in line.findings if finding.kind == "gap"]
    assert gaps == ["track.json: nothing from 0 to 100 m, at the line's begin: taken as level."]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"speed_limits": None}, "track.json: speed limits is missing."),
        (
            {"speed_limits": steps([[0, 700]], velocity="km/h")},
            "track.json: speed limits.values[0]: velocity = 700 must be at most 600 km/h.",
        ),
        (
            {"speed_limits": steps([[0, 200]], velocity="m/s")},
            "track.json: speed limits.values[0]: velocity = 200, which is 720 km/h, must be at most 600 km/h.",
        ),
        (
            {"speed_limits": steps([[0, 80]], velocity="knots")},
            "track.json: speed limits.units.velocity = 'knots' must be one of km/h, m/s.",
        ),
        (
            {"gradients": steps([[0, 1], [500, 2], [400, 3]], slope="permil")},
            "track.json: gradients.values[2].position = 400 must lie beyond 500, the one before it.",
        ),
        ({"gradients": steps([[0, "steep"]])}, "track.json: gradients.values[0][1] = 'steep' must be a number."),
        (
            {"curvatures": steps([[0, 0, 5]])},
            "track.json: curvatures.values[0]: radius = 0 must be a number other than 0, or 'infinity'.",
        ),
        (
            {"curvatures": steps([[0, "wide", 5]])},
            "track.json: curvatures.values[0]: radius = 'wide' must be a number other than 0, or 'infinity'.",
        ),
    ],
)
def test_bad_tracks_are_refused_in_one_sentence(changes, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        track_of(**changes)


def test_stops_must_rise():
    track = {**TRACK, "stops": {"unit": "m", "values": [0, 300, 200]}}
    with pytest.raises(ScenarioError, match=r"^t: stops.values\[2\].position = 200 must lie beyond 300"):
        read_track(SourceFile("t", json.dumps(track).encode()))
