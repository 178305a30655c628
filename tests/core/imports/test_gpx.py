"""Tracks in GPX: distances on the ellipsoid, speeds, heights, several tracks, and files that are meant to harm."""

import re
from pathlib import Path

import numpy as np
import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import ColumnMap, SourceFile, read_intervals
from railjoule.core.imports.cells import read_cells
from railjoule.core.imports.gpx import distance_along_m
from railjoule.core.measured import load_recording, recorder_cells, run_table

TRACK = Path(__file__).parent / "files" / "track.gpx"
"""By hand: 5 s at rest, 40 s with 0.5 m/s2, 40 s at 20 m/s, 40 s braking with 0.5 m/s2; 400 + 800 + 400 m, 8 per mille
over the first 800 m."""


def gpx(*points, before="", after=""):
    body = "".join(f'<trkpt lat="{lat}" lon="{lon}">{more}</trkpt>' for lat, lon, more in points)
    return SourceFile("t.gpx", f"<gpx>{before}<trk><trkseg>{body}</trkseg></trk>{after}</gpx>".encode())


def test_distances_are_those_on_the_ellipsoid():
    """Of WGS 84 a quarter of a meridian is 10,001,965.729 m, a degree of the equator 111,319.491 m."""
    quarter = distance_along_m(np.linspace(0, 90, 9001), np.full(9001, 7.0))
    assert quarter[-1] == pytest.approx(10_001_965.729, abs=0.01)
    equator = distance_along_m(
        np.zeros(11), np.linspace(179.5, 180.5, 11) - 360 * (np.linspace(179.5, 180.5, 11) > 180)
    )
    assert equator[-1] == pytest.approx(111_319.491, abs=0.001)
    # a parallel: N cos phi per radian, at 60 degrees 55,800.0 m a degree
    assert distance_along_m(np.full(2, 60.0), np.array([5.0, 5.01]))[-1] == pytest.approx(558.0, abs=0.05)


def test_a_recorded_track_is_a_run():
    run = run_table(recorder_cells(SourceFile.read(TRACK)))
    assert run.columns["position_m"][-1] == pytest.approx(1600, abs=0.01)
    assert run.columns["time_s"][-1] == 130
    assert max(run.columns["speed_kmh"]) == pytest.approx(72)
    recording = load_recording(TRACK)
    assert recording.duration_s == pytest.approx(120, abs=0.1)
    assert "Distances are sums of those between the points, on the ellipsoid WGS 84." in recording.notes


def test_without_speeds_those_between_the_points_count(tmp_path):
    text = TRACK.read_text()
    bare = "".join(
        line.partition("<extensions>")[0] + "</trkpt>\n" if "<extensions>" in line else f"{line}\n"
        for line in text.splitlines()
    )
    (tmp_path / "bare.gpx").write_text(bare)
    table = run_table(recorder_cells(SourceFile.read(tmp_path / "bare.gpx")))
    given = run_table(recorder_cells(SourceFile.read(TRACK)))
    # in the middle of each piece of even change the mean over two steps is the speed itself
    assert table.columns["speed_kmh"][[25, 65, 105]] == pytest.approx(
        given.columns["speed_kmh"][[25, 65, 105]], abs=0.05
    )
    assert any("no speeds" in note for note in table.notes)


def test_the_heights_of_a_track_are_a_line():
    table = read_intervals(SourceFile.read(TRACK), "heights", ColumnMap(tolerance_m=0.1))
    assert [one.value for one in table.intervals] == pytest.approx([8, 0], abs=0.05)
    assert table.intervals[0].to_m == pytest.approx(800, abs=25)


def test_one_of_several_tracks_is_chosen():
    other = '<trk><name>B</name><trkseg><trkpt lat="1" lon="1"/><trkpt lat="1" lon="2"/></trkseg></trk>'
    source = gpx((0, 0, ""), (0, 1, ""), after=other)
    with pytest.raises(ScenarioError, match=r"^t.gpx: holds 2 tracks, track 1, B; choose one track by its name"):
        read_cells(source)
    cells = read_cells(source, "B")
    assert cells.rows[-1][1] == (pytest.approx(111_302.65, abs=0.1),)  # a degree of the parallel of 1 degree
    assert cells.unused == ("t.gpx: tracks not read: track 1.",)


BOMB = "<!DOCTYPE g [" + "".join(f'<!ENTITY a{k + 1} "{f"&a{k};" * 10}">' for k in range(9)) + "]><gpx>&a9;</gpx>"


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (BOMB, "a document type (<!DOCTYPE) is not read"),
        ('<!DOCTYPE g SYSTEM "file:///etc/passwd"><gpx/>', "a document type (<!DOCTYPE) is not read"),
        ("<gpx><trk>", "not XML: "),
        ("<gpx/>", "has no track and no route"),
        ("<html><body/></html>", "its first element is 'html'; only XML of GPX is read"),
        (
            '<gpx><trk><trkpt lat="x" lon="1"/><trkpt lat="1" lon="1"/></trk></gpx>',
            "point 1: lat = 'x' must be from -90",
        ),
        ('<gpx><trk><trkpt lat="0" lon="999"/><trkpt lat="1" lon="1"/></trk></gpx>', "lon = '999' must be from -180"),
        ('<gpx><trk><trkpt lat="0" lon="9"/></trk></gpx>', "the track has 1 points, and needs at least 2"),
        (
            '<gpx><trk><trkpt lat="0" lon="9"><time>noon</time></trkpt><trkpt lat="0" lon="9.1"/></trk></gpx>',
            "point 1: time = 'noon' must be as 2026-01-31T10:15:30Z",
        ),
        ("<gpx>" + "<a>" * 100_000, "not XML: "),
    ],
)
def test_other_files_are_refused_in_one_sentence(content, sentence):
    with pytest.raises(ScenarioError, match=r"^t\.gpx.*" + re.escape(sentence)):
        read_cells(SourceFile("t.gpx", content.encode()))
