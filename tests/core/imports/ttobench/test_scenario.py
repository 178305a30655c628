import tomllib
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import Finding, SourceFile
from railjoule.core.imports.ttobench import read_ttobench
from railjoule.core.scenario import Timetable, scenario_from_document

FILES = Path(__file__).parents[1] / "files"
TRACK, TRAIN, JOURNEY = (SourceFile.read(FILES / f"ttobench-{kind}.json") for kind in ("track", "train", "journey"))
LIBRARY = Path(__file__).parents[5] / "shared" / "ttobench" / "ttobench-v1.5"
PUBLISHED = pytest.mark.skipif(not LIBRARY.is_dir(), reason="TTOBench itself is not here: ../shared/ttobench")
TRACKS = sorted(path.stem for path in (LIBRARY / "tracks").glob("*.json"))


def test_a_track_a_train_and_a_journey_are_a_scenario():
    imported = read_ttobench(TRACK, TRAIN, JOURNEY)
    scenario = scenario_from_document(tomllib.loads(imported.to_toml()))
    assert scenario.title == "Example_Track, Example_Train"
    assert (scenario.line, scenario.vehicle, scenario.travel_time_s) == (imported.line, imported.vehicle, 360)
    assert [(station.position_m, station.dwell_s) for station in scenario.line.stations] == [(2000, 30)]
    # 1 + 1 / 1 for a tunnel of 30 m2
    assert max(section.tunnel_factor for section in scenario.line.sections) == 2


def test_what_was_assumed_stands_above_the_tables():
    text = read_ttobench(TRACK, TRAIN, JOURNEY).to_toml()
    assert text.startswith("# Imported from ttobench-track.json, ttobench-train.json, ttobench-journey.json.\n# ")
    assert "# ttobench-train.json: no resistance of curves: vehicle.resistance.curve_constant_m_n_per_kn is 0." in text


def test_a_named_time_goes_before_the_journeys():
    assert read_ttobench(TRACK, TRAIN, JOURNEY, travel_time_s=500.0).travel_time_s == 500


def test_without_a_time_the_timetable_is_left_open():
    imported = read_ttobench(TRACK, TRAIN)
    assert "timetable" not in imported.document
    timed = imported.with_travel_time(400.0, Finding("assumption", "400 s."))
    assert scenario_from_document(timed.document).travel_time_s == 400
    assert "# 400 s.\n" in timed.to_toml()


def test_speeds_at_the_ends_are_kept_or_told():
    journey = SourceFile("j.json", JOURNEY.content.replace(b"[0, 0, 0, 0, 0]", b"[0, 0, 0, 30, 30]"))
    imported = read_ttobench(TRACK, TRAIN, journey)
    kept = imported.document["timetable"].get("entry_speed_kmh") == 30
    assert (kept, "j.json: entry_speed_kmh = 30: the train stands there in a scenario." in imported.unused) == (
        ("entry_speed_kmh" in Timetable.model_fields),
        "entry_speed_kmh" not in Timetable.model_fields,
    )


def test_a_journey_must_stay_on_its_track():
    journey = SourceFile("j.json", JOURNEY.content.replace(b"[5000, 330", b"[5001, 330"))
    with pytest.raises(ScenarioError, match=r"^j.json: runs from 0 to 5,001 m, and must stay within 0 to 5,000 m of "):
        read_ttobench(TRACK, TRAIN, journey)


def test_stops_that_a_journey_passes_are_told():
    points = b"[2000, 120, 150, 0, 0],\n            [2000, 180, 200, 0, 0],\n"
    assert points in JOURNEY.content
    imported = read_ttobench(TRACK, TRAIN, SourceFile("j.json", JOURNEY.content.replace(points, b"")))
    assert imported.line.stations == ()
    assert "ttobench-track.json: stops that the journey passes, at 2,000 m." in imported.unused


@PUBLISHED
@pytest.mark.parametrize("track", TRACKS)
def test_every_published_track_becomes_a_line(track):
    """Its length and the number of its stops are those of the library's own table."""
    rows = [row.split(",") for row in (LIBRARY / "tracks" / "tracks.csv").read_text().splitlines()]
    lengths = {row[0]: (float(row[6]), int(row[10])) for row in rows[1:]}
    imported = read_ttobench(
        SourceFile.read(LIBRARY / "tracks" / f"{track}.json"),
        SourceFile.read(LIBRARY / "trains" / "CH_Stadler_FLIRT_TPF.json"),
        travel_time_s=3000.0,
    )
    length, stops = lengths.get(track, (48531.0, 4))  # one with tunnels is not in the table
    assert imported.line.length_m == pytest.approx(length, abs=1e-6)
    assert len(imported.line.stations) == stops - 2
    assert not [finding for finding in imported.findings if finding.kind in {"question", "gap", "overlap"}]
    assert scenario_from_document(tomllib.loads(imported.to_toml())).line == imported.line


@PUBLISHED
@pytest.mark.parametrize(
    "train", ["CH_Stadler_FLIRT_TPF", "CH_Stadler_KISS_SBB", "CN_Beijing_Subway", "NL_Intercity_VIRM6"]
)
def test_no_published_train_is_doubted(train):
    imported = read_ttobench(TRACK, SourceFile.read(LIBRARY / "trains" / f"{train}.json"))
    assert not [finding.sentence for finding in imported.findings if finding.kind == "question"]


@PUBLISHED
def test_the_published_journey_is_read():
    name = "CH_StGallen_Wil"
    files = [LIBRARY / "tracks" / f"{name}.json", LIBRARY / "trains" / "CH_Stadler_FLIRT_TPF.json"]
    imported = read_ttobench(
        *map(SourceFile.read, files), SourceFile.read(LIBRARY / "journeys" / f"{name}_Journey_01.json")
    )
    assert imported.travel_time_s == 1450
    assert [(station.position_m, station.dwell_s) for station in imported.line.stations] == [(15000, 120)]
