"""What a file is, by its content."""

from pathlib import Path

import pytest

from railjoule.core.errors import RailjouleError
from railjoule.core.imports import SourceFile
from railjoule.dashboard.pages.imports.brought import Brought
from railjoule.dashboard.pages.imports.cards import card_of

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
    called = name if name.endswith(".csv") else "download.bin"
    assert Brought.of(1, SourceFile(called, source.content)).kind == kind


def test_a_published_table_needs_no_name() -> None:
    content = (FILES / "sncf-gradients.csv").read_bytes()
    assert Brought.of(1, SourceFile("1.csv", content)).kind == "gradients"


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
    failure = card_of(Brought.of(1, SourceFile.read(FILES / name))).failure
    assert failure.endswith("files of OSRD and railtoolkit are read by the command railjoule import.")


@pytest.mark.parametrize("content", HOSTILE.values(), ids=list(HOSTILE))
@pytest.mark.parametrize("name", ["a.csv", "a.json", "a.yaml", "limits<img src=x>.xlsx"])
def test_hostile_content_gets_one_sentence(name: str, content: bytes) -> None:
    card = card_of(Brought.of(1, SourceFile(name, content)))
    assert card.result is None
    assert card.failure.startswith(name)
    assert card.failure.endswith(".")
    assert len(card.failure) < 500


def test_a_file_that_did_not_arrive_is_told() -> None:
    with pytest.raises(RailjouleError, match=r"a\.csv: it did not arrive whole; choose it again\."):
        _ = Brought(1, "a.csv", "no base64!").kind
