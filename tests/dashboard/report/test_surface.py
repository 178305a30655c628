import json

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.dashboard.charts.surface import TALLEST
from railjoule.dashboard.pages.trade_off.compute import EnocMap, compute_enoc_map
from railjoule.dashboard.report.surface import MAX_NODES, enoc_surface


@pytest.fixture(scope="module")
def enoc() -> EnocMap:
    found = compute_enoc_map(load_scenario("ftorek-300s"))
    assert found is not None
    return found


def shares(enoc: EnocMap, time_s: float, ramp_s: float, energy_kwh: float) -> list[float]:
    """Return a place as shares of the axes, as the surface has it."""
    energy = enoc.energy_kwh[enoc.energy_kwh <= TALLEST * np.nanmin(enoc.energy_kwh)]
    axes = (enoc.travel_time_s, enoc.acceleration_time_s, energy)
    return [(v - a.min()) / np.ptp(a) for v, a in zip((time_s, ramp_s, energy_kwh), axes, strict=True)]


def test_the_surface_of_enoc_has_the_map_s_own_numbers(enoc: EnocMap) -> None:
    faces = [points for points, *_ in enoc_surface(enoc)["pieces"] if len(points) == 4]
    assert 500 < len(faces) <= (MAX_NODES - 1) ** 2
    corners = np.array(faces).reshape(-1, 3)
    assert corners.min(axis=0) == pytest.approx([0, 0, 0], abs=0.01)
    assert corners[:, :2].max(axis=0) == pytest.approx([1, 1], abs=1e-3)
    # the height of one corner is the energy of the map at its place
    row, column = 5, 60
    there = shares(enoc, enoc.travel_time_s[column], enoc.acceleration_time_s[row], enoc.energy_kwh[row, column])
    assert corners[np.argmin(np.hypot(*(corners[:, :2] - there[:2]).T))][2] == pytest.approx(there[2], abs=0.03)


def test_valley_and_run_lie_on_the_surface_of_enoc(enoc: EnocMap) -> None:
    run = solve(load_scenario("ftorek-300s"), "enoc")
    surface = enoc_surface(enoc, run)
    assert "dot: its run" in surface["caption"]
    lines = [points for points, colour, *_ in surface["pieces"] if len(points) == 2 and colour == "#FFFFFF"]
    # the last one is the edge of the dot
    valley, place = np.array(lines[:-1])[:, 0], lines[-1][0]
    # 31.0 s: the run's own note; the axis of energies is a little shorter, as a thinned map has fewer of them
    assert place == pytest.approx(shares(enoc, run.travel_time_s, 31.0, run.energy_kwh), abs=0.02)
    # the run has the best acceleration time, so it lies in the valley
    assert place[1] == pytest.approx(np.interp(place[0], valley[:, 0], valley[:, 1]), abs=5e-3)
    assert place[2] == pytest.approx(np.interp(place[0], valley[:, 0], valley[:, 2]), abs=5e-3)
    assert np.all(np.diff(valley[:, 0]) > 0)
    assert "dot" not in enoc_surface(enoc)["caption"]


def test_ticks_are_round_and_keep_clear_of_the_corners(enoc: EnocMap) -> None:
    for ticks in enoc_surface(enoc)["ticks"]:
        assert 2 <= len(ticks) <= 6
        assert all(0.05 < share < 0.95 for share, _ in ticks)
        assert all(float(text) * 2 == round(float(text) * 2) for _, text in ticks)


def test_the_surface_is_json(enoc: EnocMap) -> None:
    assert json.loads(json.dumps(enoc_surface(enoc), allow_nan=False))["titles"][0] == "Travel time, s"


def test_a_scenario_that_enoc_does_not_take_has_no_such_surface() -> None:
    assert compute_enoc_map(load_scenario("metro-with-limit")) is None
