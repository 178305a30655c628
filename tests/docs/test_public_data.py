"""The tutorial from a public data set to a report: its commands print what it shows, and its numbers are right."""

import itertools
import json
import math
import re
import shlex
import shutil

import pytest
from documents import ROOT, blocks_in, text_of
from ttobench import ABSENT, FOLDER

from railjoule.dashboard.command.cli import OK, main

PAGE = text_of("tutorials/public_data")
SHIPPED = ROOT / "assets" / "imports"
TRACK, TRAIN = "CH_StGallen_Wil", "NL_Intercity_VIRM6"
G_MS2, MASS_T, CURVE_CONSTANT = 9.81, 391.0, 700.0
MS_EETC_KWH = {300: 50.0234, 1000: 49.9800}
"""Results of ms-eetc (commit d7aadf2, CasADi 3.8.2) for the setting of its simulations/table4.py, by intervals."""
FEWER_CELLS = "timetable.reserve_percent=10 -o", "timetable.reserve_percent=10 solver.mesh_m=200 -o"
"""The report of the test has fewer cells; the numbers of the page are those of the commands before it."""


def commands():
    """Return the commands of the page with the lines that it shows, which end at an ellipsis."""
    pairs = itertools.pairwise(blocks_in(PAGE))
    return [(one.text.strip(), two.text.splitlines()) for one, two in pairs if one.kind == "sh"]


def test_the_commands_print_what_is_shown(tmp_path, monkeypatch, capsys):
    for name in (TRACK, TRAIN):
        shutil.copy(SHIPPED / f"{name}.json", tmp_path)
    monkeypatch.chdir(tmp_path)
    for command, shown in commands():
        assert main(shlex.split(command.replace(*FEWER_CELLS))[1:]) == OK
        output = capsys.readouterr()
        lines = iter(re.sub(r"[\u00a0\u202f\u2009]", " ", output.err + output.out).splitlines())
        for line in shown:
            # in the order of the page
            assert any(one.startswith(line.partition("\u2026")[0]) for one in lines), f"{command}: {line}"
    assert (tmp_path / "st-gallen-wil.html").stat().st_size > 1e6


def section_ends(rows, length_m):
    """Return the ends of sections that begin at given positions."""
    return [*(row[0] for row in rows[1:]), length_m]


def test_height_curves_and_the_published_program_agree():
    track = json.loads((SHIPPED / f"{TRACK}.json").read_text(encoding="utf-8"))
    length_m = track["stops"]["values"][-1]
    slopes, radii = track["gradients"]["values"], track["curvatures"]["values"]
    fall_m = -sum(
        (end - row[0]) * row[1] / 1000 for row, end in zip(slopes, section_ends(slopes, length_m), strict=True)
    )
    assert f"{fall_m:.1f} m of height" in PAGE
    assert re.search(rf"potential, end minus start +-{MASS_T * G_MS2 * fall_m / 3600:.2f}$", PAGE, re.MULTILINE)
    # the work of curves depends on no speed: weight, constant and the sum of all angles, of either side
    angle = 0.0
    for (begin, *ends), end in zip(radii, section_ends(radii, length_m), strict=True):
        one, two = (0.0 if radius == "infinity" else 1 / radius for radius in ends)
        both_sides = (one**2 + two**2) / (abs(one) + abs(two)) if one * two < 0 else abs(one + two)
        angle += 0.5 * both_sides * (end - begin)
    work_kwh = CURVE_CONSTANT * angle * MASS_T * G_MS2 / 3.6e6
    assert re.search(rf"^  curves +{work_kwh:.2f}$", PAGE, re.MULTILINE)
    section = PAGE.partition("## 7.")[2].partition("## 8.")[0]
    energy, bound = (
        float(re.search(rf"^{word} +([\d.]+) kWh", section, re.MULTILINE)[1]) for word in ("Energy", "Bound")
    )
    for intervals, other in MS_EETC_KWH.items():
        assert re.search(rf"ms-eetc.*\| {intervals} \| {other:.2f} kWh", section)
        assert bound <= energy <= other
    assert math.isclose(energy, MS_EETC_KWH[1000], rel_tol=2e-3)


@pytest.mark.skipif(not FOLDER.is_dir(), reason=ABSENT)
def test_the_shipped_files_have_the_values_of_the_library():
    for folder, name in (("tracks", TRACK), ("trains", TRAIN)):
        original, shipped = ((path / f"{name}.json").read_text("utf-8") for path in (FOLDER / folder, SHIPPED))
        assert json.loads(shipped) == json.loads(original)
