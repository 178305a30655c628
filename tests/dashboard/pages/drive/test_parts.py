import re
from xml.etree import ElementTree

import numpy as np
import pytest
from markup import plain

from railjoule.core import load_scenario, solve
from railjoule.core.energy_along import EnergyFlow, energy_flow
from railjoule.core.simulation.actual_run import ActualRun, actual_run
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.bellman import bellman_with_law
from railjoule.dashboard.look.tokens import LIGHT
from railjoule.dashboard.pages.drive.charts import COLUMNS, ROWS, sampled
from railjoule.dashboard.pages.drive.sankey import BACK, BRAKE, DRIVE, LINE, TRAIN, build_links, sankey
from railjoule.dashboard.pages.drive.texts import actual_figures, causes_block
from railjoule.dashboard.work.runs import RunsRequest, compute_runs


@pytest.fixture(scope="module", params=["metro-with-limit", "liashenko-iii", "tram-950m"])
def flow(request: pytest.FixtureRequest) -> EnergyFlow:
    return energy_flow(solve(load_scenario(request.param)))


def test_as_much_arrives_at_a_knot_as_leaves_it(flow: EnergyFlow) -> None:
    links = build_links(flow)
    for knot in (DRIVE, TRAIN, BRAKE):
        arriving = sum(link.joules for link in links if link.target == knot)
        leaving = sum(link.joules for link in links if link.source == knot)
        # flows under a ten-thousandth of what the line gives are not drawn
        assert arriving == pytest.approx(leaving, abs=5e-4 * flow.energy.traction_j)
    taken = sum(link.joules for link in links if link.source == LINE)
    back = sum(link.joules for link in links if link.target == BACK)
    assert taken - back == pytest.approx(flow.energy.net_j, rel=1e-3)


@pytest.mark.parametrize("width", [640.0, 900.0])
def test_the_svg_stays_within_its_width_and_says_its_numbers(flow: EnergyFlow, width: float) -> None:
    markup = sankey(flow, LIGHT, width, "Energy")
    svg = ElementTree.fromstring(markup[markup.index("<svg") : markup.index("</svg>") + 6])
    assert svg.get("role") == "img"
    name = "{http://www.w3.org/2000/svg}"
    assert len(svg.findall(f"{name}path")) >= len(build_links(flow))
    for link in build_links(flow):
        assert f"{link.source} to {link.target}" in (svg.get("aria-label") or "")
    starts = [float(x) for x in re.findall(r'<(?:rect|text) x="([-0-9.]+)"', markup)]
    assert min(starts) >= 0
    assert max(starts) < width


def test_the_map_shows_the_law() -> None:
    run, law = bellman_with_law(prepare_task(load_scenario("liashenko-0")))
    image, top = sampled(law)
    assert image.shape == (ROWS, COLUMNS)
    assert top == law.speed_ms.max()
    # full traction at low speed behind the start, full braking cannot be needed there
    assert image[1, 5] > 0.99
    # too fast to stop any more: the end cannot be reached
    assert np.isnan(image[-1, -2])
    assert np.nanmin(image) >= -1 - 1e-9
    assert np.nanmax(image) <= 1 + 1e-9
    assert run.strategy == "bellman"


def told(load_factor: float, error_m: float) -> tuple[ActualRun, str, str]:
    changes = {"disturbance.actual_load_factor": load_factor, "disturbance.coordinate_error_m": error_m}
    scenario = load_scenario("metro-with-limit", {"simulation.target_braking": False, **changes})
    runs = compute_runs(RunsRequest(load_scenario("metro-with-limit"), ("optimal",)))
    actual = actual_run(scenario)
    return actual, plain(actual_figures(actual, runs, runs.best)), plain(causes_block(actual))


def test_less_energy_by_a_miss_is_no_saving() -> None:
    actual, head, causes = told(0.25, 10.0)
    assert actual.extra_kwh < 0
    assert actual.stop_error_m == -10
    assert re.match(r"Actual run [\d.]+ m short of the stop [\d.]+ kWh against 7\.81 planned", head)
    assert "Causes of the difference: 0." in causes
    assert "kWh less" in causes
    assert "run saves" not in head
    assert "saving" not in causes


def test_less_energy_in_time_is_a_saving() -> None:
    actual, head, causes = told(0.0, 0.0)
    assert actual.extra_kwh < 0
    assert head.startswith("Actual run saves \u2212")
    assert "Causes of the saving: " in causes
