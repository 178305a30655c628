"""Heights become gradients: exactly where they lie on straight pieces, near the truth where they have errors."""

import numpy as np
import pytest

import railjoule as rj
from railjoule.core.errors import ScenarioError, UnitError
from railjoule.core.imports import ColumnMap, SourceFile, build_line, read_intervals
from railjoule.core.imports.heights import fit_heights

KNOTS_M, HEIGHTS_M = np.array([0.0, 1000, 2500, 3000, 5000]), np.array([120, 128, 128, 121.5, 150])
GRADIENTS = [8, 0, -13, 14.25]
"""Differences of `HEIGHTS_M` over those of `KNOTS_M`, in per mille: the profile of row 13 of the field test."""


def read(text, name="h.csv", **columns):
    return read_intervals(SourceFile(name, text.encode()), "heights", ColumnMap(**columns))


def profile(every_m):
    """Return places and exact heights of the profile at equal distances."""
    position = np.arange(0, 5000 + every_m, every_m, dtype=float)
    return position, np.interp(position, KNOTS_M, HEIGHTS_M)


@pytest.mark.parametrize("every_m", [500, 100, 20])
def test_heights_on_straight_pieces_give_their_gradients(every_m):
    found = fit_heights(*profile(every_m), 1.0)
    assert found.knots_m.tolist() == KNOTS_M.tolist()
    assert found.gradients_permille == pytest.approx(GRADIENTS, abs=1e-9)


@pytest.mark.parametrize("header", ["position_m,elevation_m", "km,Höhe [ft]", "Distance [km],Altitude (m)"])
def test_a_table_of_heights_gives_gradients_with_the_method(header):
    places = KNOTS_M / (1 if header.startswith("position") else 1000)
    heights = HEIGHTS_M / (0.3048 if "ft" in header else 1)
    rows = "".join(f"{a!r},{h!r}\n" for a, h in zip(places.tolist(), heights.tolist(), strict=True))
    table = read(f"{header}\n{rows}")
    assert [one.value for one in table.intervals] == pytest.approx(GRADIENTS, abs=1e-9)
    assert table.kind == "gradients"
    (method,) = [one.sentence for one in table.findings if "Douglas and Peucker" in one.sentence]
    assert "heights.tolerance_m = 1 m" in method
    assert method in build_line(heights=table).to_toml().replace("# ", "")


@pytest.mark.parametrize("seed", range(8))
def test_errors_of_heights_average_out(seed):
    """Independent truth: 201 heights with errors of 0.25 m, whose differences climb 49 m instead of 36.5 m."""
    position, truth = profile(25)
    measured = truth + np.random.default_rng(seed).normal(0, 0.25, len(truth))
    found = fit_heights(position, measured, 1.0)
    line = np.interp(position, found.knots_m, found.height_m)
    assert np.max(np.abs(line - measured)) <= 1.0 + 1e-6
    assert np.sqrt(np.mean((line - truth) ** 2)) < 0.3
    assert np.maximum(np.diff(found.height_m), 0).sum() == pytest.approx(36.5, rel=0.03)
    assert np.maximum(np.diff(measured), 0).sum() > 45
    # over the long pieces, away from their ends
    for place, gradient in zip((500, 1750, 4000), (8, 0, 14.25), strict=True):
        piece = np.interp([place - 300, place + 300], found.knots_m, found.height_m)
        assert np.diff(piece)[0] / 0.6 == pytest.approx(gradient, abs=1.5)


def test_a_larger_tolerance_leaves_fewer_pieces():
    position, truth = profile(25)
    measured = truth + np.random.default_rng(1).uniform(-0.9, 0.9, len(truth))
    pieces = [len(fit_heights(position, measured, tolerance).knots_m) - 1 for tolerance in (0.0, 1.0, 2.0, 60.0)]
    assert pieces[0] > 150
    assert pieces == sorted(pieces, reverse=True)
    assert pieces[2:] == [4, 1]


def test_gradients_of_errors_are_asked_about():
    position, truth = profile(25)
    measured = truth + np.random.default_rng(1).normal(0, 2.0, len(truth))
    text = "position_m,height_m\n" + "".join(f"{a},{h}\n" for a, h in zip(position, measured, strict=True))
    with pytest.raises(ScenarioError, match=r"with a tolerance of 1 m its gradients reach .* as heights.tolerance_m=5"):
        read(text)
    table = read(text, tolerance_m=8.0)
    assert max(abs(one.value) for one in table.intervals) < 20


@pytest.mark.parametrize(
    ("text", "columns", "sentence"),
    [
        (
            "m,height_m\n0,1\n0,9\n100,3\n",
            {"columns": {"from": "m"}},
            "rows 2 and 3 give two heights at 0 m, 1 and 9 m",
        ),
        ("position_m,height_m\n5,1\n5,1\n", {}, "needs heights at two places at least"),
        ("position_m,height_m\n0,1\n900,99999\n", {}, "99999 m at 900 m must be a height from -1000 to 10000 m"),
        ("position_m,height_m\n0,1\n900,2\n", {"tolerance_m": -1.0}, "heights.tolerance_m = -1 must be 0 to 100 m"),
    ],
)
def test_what_is_no_profile_is_refused(text, columns, sentence):
    with pytest.raises(ScenarioError) as refused:
        read(text, **columns)
    assert sentence in str(refused.value)


def test_heights_beyond_all_railways_without_a_unit_are_asked_about():
    with pytest.raises(UnitError, match=r"heights reach 8000 m; name the unit, as heights.value_unit=ft"):
        read("km,height\n0,7990\n5,8000\n")


def test_heights_and_gradients_exclude_each_other():
    heights = read("km,height_m\n0,100\n5,130\n")
    gradients = read_intervals(SourceFile("g.csv", b"from_m,to_m,gradient\n0,5000,6\n"), "gradients")
    with pytest.raises(ScenarioError, match=r"g.csv and h.csv both give the gradients; leave out one of them"):
        build_line(heights=heights, gradients=gradients)


def test_a_line_of_tables_takes_heights(tmp_path):
    (tmp_path / "h.csv").write_text("km,height_m\n0,100\n5,130\n")
    with pytest.warns(UserWarning, match="Douglas and Peucker"):
        line = rj.Line.from_tables(heights=tmp_path / "h.csv")
    assert [(one.length_m, one.gradient_permille) for one in line.sections] == [(5000, 6)]
