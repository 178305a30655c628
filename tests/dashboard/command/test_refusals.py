"""Whatever is wrong with the words of a command or with a file that they name ends in one sentence, and writes nothing.

In the table refusals.txt, a command stands after a dollar sign, and below it its sentence, or the beginning of one that
ends in three dots.
"""

import shlex
from pathlib import Path

import pytest
from commands import complaint

from railjoule.core import load_scenario, solve
from railjoule.core.bounds import LONGEST_PROOF_S
from railjoule.core.measured import RecorderFormat
from railjoule.dashboard.command.cli import OK, main
from railjoule.dashboard.command.shared_options import RECORDING
from railjoule.dashboard.command.values import LONGEST_TIME_S

ROOT = Path(__file__).parents[3]
FILES = ROOT / "tests" / "core" / "imports" / "files"
LONG = {
    "files": FILES,
    "run": ROOT / "assets" / "recordings" / "liashenko-ii-83s.csv",
    "long": "x" * 5000,
    "digits": "9" * 5000,
}
"""Values of the names in braces in the table."""
GIVEN = {
    "empty.csv": "",
    "torn.csv": 'a,b\n1,2\n"3',
    "ragged.csv": "a\n1,2,3\n4,5\n6,7,8,9\n",
    "binary.csv": "\0\1\2",
    "no.parquet": "no parquet",
    "words.csv": "position_m,time_s,speed_kmh\n0,0,0\n9,later,0\n",
    "other.html": "<html></html>",
    "long.txt": "x" * 2001,
    "broken.toml": "title = ",
    "large.toml": "#" * 10_000_001,
}
LINES = (Path(__file__).parent / "refusals.txt").read_text(encoding="utf-8").splitlines()
REFUSALS = list(zip(LINES[::2], LINES[1::2], strict=True))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a run, a line, and files that are none of what they seem."""
    made = tmp_path_factory.mktemp("given")
    for name, text in GIVEN.items():
        (made / name).write_text(text, encoding="utf-8")
    (made / "no-text.toml").write_bytes(b"\xff\xfe\x00")
    for name in ("folder.csv", "folder.parquet"):
        (made / name).mkdir()
    solve(load_scenario("liashenko-ii")).to_dataframe().to_csv(made / "run.csv", index=False)
    assert main(["import", "intervals", "--limits", str(FILES / "limits.csv"), "-o", str(made / "line.toml")]) == OK
    return made


@pytest.mark.parametrize(("command", "sentence"), REFUSALS, ids=[command[2:80] for command, _ in REFUSALS])
def test_one_sentence_and_no_file(capsys, folder, monkeypatch, command, sentence):
    monkeypatch.chdir(folder)
    capsys.readouterr()
    before = sorted(folder.iterdir())
    words = [word.format(**LONG) if word.startswith("{") else word for word in shlex.split(command.removeprefix("$"))]
    message = complaint(capsys, *words)
    if sentence.endswith("..."):
        assert message.startswith(sentence.removesuffix("..."))
    else:
        assert message == sentence
    assert sorted(folder.iterdir()) == before


def test_a_complaint_cannot_steer_the_terminal(capsys):
    assert "\x1b" not in complaint(capsys, "solve", "evil\x1b[2J\nname.toml")


def test_bounds_that_the_parser_repeats_are_those_of_the_core():
    """It repeats them, as it is there before the core is imported."""
    assert LONGEST_TIME_S == LONGEST_PROOF_S
    (gap,) = (settings["default"] for names, settings in RECORDING if "--longest-gap" in names)
    assert gap == RecorderFormat.longest_gap_s
