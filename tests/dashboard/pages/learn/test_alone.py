"""What the browser has to judge by where no server answers; its verdicts are compared in tests/browser/test_scripts."""

import json

import numpy as np
import pytest

from railjoule.core import solve
from railjoule.core.bounds import certify, minimise
from railjoule.core.strategies import prepare_task
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.pages.learn import alone, drawing


@pytest.mark.parametrize("make", [alone.drive_it, alone.share_out, alone.draw_speed])
def test_it_can_be_written_down(make) -> None:
    # no NaN, which a browser would refuse
    assert json.loads(json.dumps(make(), allow_nan=False))


def test_the_optima_are_those_of_the_page() -> None:
    optima = alone.drawing_optima()
    scenario, _ = drawing.drawing_lesson()
    for run in optima.runs[:: alone.OPTIMA_COUNT // 4]:
        own = solve(scenario.with_(**{"timetable.travel_time_s": run.travel_time_s}))
        assert run.energy_kwh == pytest.approx(own.energy_kwh, rel=1e-6)
        assert optima.lines.energy_j_at(run.travel_time_s) == pytest.approx(own.energy.net_j, rel=1e-6)


def test_what_is_proven_between_two_optima_is_close_to_the_least_energy() -> None:
    lines = alone.drawing_optima().lines
    scenario, _ = drawing.drawing_lesson()
    for k in (0, 60, 120, 180, alone.OPTIMA_COUNT - 2):
        time = float(np.mean(lines.travel_time_s[k : k + 2]))
        task = prepare_task(scenario.with_(**{"timetable.travel_time_s": time}))
        proven = certify(task, minimise(task).optimum).energy_j
        assert proven * (1 - 1e-4) <= lines.energy_j_at(time) <= proven * (1 + 1e-6)


def test_every_drawing_has_an_optimum_of_no_longer_time() -> None:
    data = alone.draw_speed()
    times = [one["time_s"] for one in data["optima"]]
    assert times == sorted(times)
    # the browser compares from half a second beyond the shortest time on
    assert times[0] < data["shortest_s"] + 0.5
    assert times[-1] > drawing.run_of((drawing.LEAST_KMH,) * drawing.POINTS).travel_time_s
    assert data["bounds"]["kwh"][0] * J_PER_KWH == alone.drawing_optima().lines.energy_j[0]


def test_the_nodes_that_are_kept_give_all_others() -> None:
    for run in alone.drawing_optima().runs[::40]:
        kept = alone.kept_nodes(run)
        assert kept[0] == 0
        assert kept[-1] == len(run.nodes_m) - 1
        assert len(kept) < 0.15 * len(run.nodes_m)
        places = run.nodes_m[kept]
        speed = np.sqrt(np.interp(run.nodes_m, places, run.node_speed_ms[kept] ** 2))
        assert speed == pytest.approx(run.node_speed_ms, abs=alone.DRAWN_MS)
        energy = np.interp(run.nodes_m, places, run.line_energy_j[kept]) / J_PER_KWH
        assert energy == pytest.approx(run.line_energy_j / J_PER_KWH, abs=alone.DRAWN_KWH)
