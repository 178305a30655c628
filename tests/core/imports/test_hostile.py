"""Whatever a file holds, it is read or refused in one sentence: examples with bytes changed, taken out and put in."""

import random
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railjoule.core import RailjouleError
from railjoule.core.imports import INTERVAL_KINDS, SourceFile, build_line, read_intervals, read_stations
from railjoule.core.imports.osrd_stock import read_osrd_stock
from railjoule.core.imports.railtoolkit import read_railtoolkit
from railjoule.core.imports.ttobench import read_track, read_train
from railjoule.core.imports.ttobench.journey import read_service
from railjoule.core.measured import RecorderFormat, recorder_cells, run_table, to_recording

GENERIC = RecorderFormat()
FILES = Path(__file__).parent / "files"
LEVEL = read_intervals(SourceFile("level.csv", b"from_m,to_m,gradient\n0,1500,0\n"), "gradients")
PIECES = [b"", b"\0", b"\xff", b"=1+1", b"-", b"1e999", b"NaN", b"null", b"{", b'"', b";", b",", b"\n"]
PIECES += [b"9" * 400, b"[" * 100]


def read_line(kind, source):
    build_line(**{kind: read_intervals(source, kind)}).to_toml()


def read_stops(source):
    build_line(gradients=LEVEL, stations=read_stations(source)).to_toml()


def read_run(source, form=GENERIC):
    """Read a recorder's file both as a table and as a recording."""
    cells = recorder_cells(source, form)
    run_table(cells, form)
    to_recording(cells, form)


READERS: dict[str, list[Callable[[SourceFile], object]]] = {
    "gradients.csv": [partial(read_line, kind) for kind in INTERVAL_KINDS],
    "sncf-curves.csv": [partial(read_line, "curves"), partial(read_line, "gradients")],
    "stations.csv": [read_stops, partial(read_line, "heights")],
    "track.gpx": [read_run, partial(read_line, "heights")],
    "osrd-run.csv": [read_run],
    "run.csv": [read_run],
    "osrd-stock.json": [read_osrd_stock],
    "ttobench-train.json": [read_train],
    "ttobench-track.json": [read_track],
    "ttobench-journey.json": [read_service],
    "railtoolkit-train.yaml": [read_railtoolkit],
    "railtoolkit-detailed.yaml": [read_railtoolkit],
    "railtoolkit-path.yaml": [read_railtoolkit],
}


def broken(content: bytes, seed: int) -> bytes:
    """Return a file with one to four pieces of it replaced."""
    chance = random.Random(seed)
    for _ in range(chance.randint(1, 4)):
        begin = chance.randrange(len(content) + 1)
        end = min(begin + chance.choice([0, 0, 1, 3, 20]), len(content))
        content = content[:begin] + chance.choice(PIECES) + content[end:]
    return content


def refusal(read: Callable[[SourceFile], object], source: SourceFile) -> str | None:
    """Return the sentence by which a file is refused, None where it is read."""
    try:
        read(source)
    except RailjouleError as error:
        return str(error)
    return None


@pytest.mark.parametrize("name", READERS)
@given(seed=st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_broken_files_are_read_or_refused_in_one_sentence(name, seed):
    content = broken((FILES / name).read_bytes(), seed)
    for read in READERS[name]:
        sentence = refusal(read, SourceFile(name, content))
        assert sentence is None or (sentence.startswith(name) and sentence.endswith((".", "?")) and len(sentence) < 900)


@given(content=st.binary(max_size=200))
@settings(max_examples=200, deadline=None)
def test_any_bytes_are_refused_or_read(content):
    for readers in READERS.values():
        for read in readers:
            sentence = refusal(read, SourceFile("a", content))
            assert sentence is None or sentence.startswith("a")
