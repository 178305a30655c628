"""What a file is, by its content."""

from pathlib import Path

import pytest

from railjoule.core.imports import SourceFile
from railjoule.dashboard.pages.files.brought import Brought
from railjoule.dashboard.pages.files.cards import build_card

ASSETS = Path(__file__).parents[4] / "assets"
FILES = Path(__file__).parents[3] / "core" / "imports" / "files"
KINDS = {
    "sncf-limits.csv": "limits",
    "sncf-gradients.csv": "gradients",
    "sncf-curves.csv": "curves",
    "gradients.csv": "gradients",
    "limits.csv": "limits",
    "curves.csv": "curves",
    "ttobench-track.json": "track",
    "ttobench-train.json": "train",
    "ttobench-journey.json": "journey",
}


@pytest.mark.parametrize(("name", "kind"), KINDS.items())
def test_a_file_is_known_by_its_content(name: str, kind: str) -> None:
    source = SourceFile.read(FILES / name)
    # but for tables, the name says nothing
    assert Brought(1, name if name.endswith(".csv") else "download.bin", source.content).kind == kind


def test_a_published_table_needs_no_name() -> None:
    assert Brought(1, "1.csv", (FILES / "sncf-gradients.csv").read_bytes()).kind == "gradients"


HOSTILE = {
    "nothing": b"",
    "NUL": b"a,b\n\0,1\n",
    "a picture": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
    "deep JSON": b'{"a":' * 100_000,
    "a list": b"{]",
    "unknown JSON": b'{"a": 1}',
    "a broken workbook": b"PK\x03\x04garbage",
    "an old workbook": b"\xd0\xcf\x11\xe0garbage",
    "wide": b",".join(b"c%d" % k for k in range(10_000)) + b"\n" + b",".join(b"1" for _ in range(10_000)),
    "prose": b"Dear Sir, or Madam\nI write to you\n",
}


@pytest.mark.parametrize("name", ["osrd-stock.json", "railtoolkit-train.yaml"])
def test_a_file_that_only_the_command_line_reads_names_the_command(name: str) -> None:
    failure = build_card(Brought(1, name, (FILES / name).read_bytes())).failure
    assert failure.endswith("files of OSRD and railtoolkit are read by the command railjoule import.")


@pytest.mark.parametrize("content", HOSTILE.values(), ids=list(HOSTILE))
@pytest.mark.parametrize("name", ["a.csv", "a.json", "a.yaml", "limits<img src=x>.xlsx"])
def test_hostile_content_gets_one_sentence(name: str, content: bytes) -> None:
    card = build_card(Brought(1, name, content))
    assert card.result is None
    assert card.failure.startswith(name)
    assert card.failure.endswith(".")
    assert len(card.failure) < 500


RUNS = {
    "time and speed": "time_s,speed_kmh\n" + "".join(f"{k},{k}\n" for k in range(12)),
    "place and speed": "position_m,speed_kmh\n" + "".join(f"{k},{k}\n" for k in range(12)),
    "a row above": "made by a program\nUhrzeit;v [km/h]\n" + "".join(f"{k};{k}\n" for k in range(12)),
    "no speed": "time_s,x\n" + "".join(f"{k},{k}\n" for k in range(12)),
}


@pytest.mark.parametrize("content", RUNS.values(), ids=list(RUNS))
def test_a_recorded_run_is_known_by_its_columns(content: str) -> None:
    file = Brought(1, "limits of speed.csv" if content == RUNS["time and speed"] else "a.csv", content.encode())
    assert file.kind == "run"
    assert [run.name for run in file.runs] == [file.name]


def test_a_table_of_limits_over_places_is_no_run() -> None:
    content = b"from_km,to_km,speed_kmh\n0,1,60\n1,3,80\n"
    assert Brought(1, "a.csv", content).kind == "limits"
    # the user has the last word
    assert Brought(1, "a.csv", content).with_kind("run").kind == "run"


@pytest.mark.parametrize("name", ["metro-0714.csv", "liashenko-ii-108s.csv"])
def test_shipped_recordings_are_runs(name: str) -> None:
    assert Brought(1, name, (ASSETS / "recordings" / name).read_bytes()).kind == "run"


def test_the_shipped_file_of_a_recorder_is_a_run() -> None:
    assert Brought(1, "x.csv", (ASSETS / "imports" / "example-recorder.csv").read_bytes()).kind == "run"
