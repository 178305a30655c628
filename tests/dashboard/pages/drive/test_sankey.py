import re
from xml.etree import ElementTree

import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.energy_flow import EnergyFlow, energy_flow
from railjoule.dashboard.look.tokens import LIGHT
from railjoule.dashboard.pages.drive.sankey import BACK, BRAKE, DRIVE, LINE, TRAIN, links_of, sankey


@pytest.fixture(scope="module", params=["metro-with-limit", "liashenko-iii", "tram-950m"])
def flow(request: pytest.FixtureRequest) -> EnergyFlow:
    return energy_flow(solve(load_scenario(request.param)))


def test_as_much_arrives_at_a_knot_as_leaves_it(flow: EnergyFlow) -> None:
    links = links_of(flow)
    for knot in (DRIVE, TRAIN, BRAKE):
        arriving = sum(link.joules for link in links if link.target == knot)
        leaving = sum(link.joules for link in links if link.source == knot)
        # flows under a ten-thousandth of what the line gives are not drawn
        assert arriving == pytest.approx(leaving, abs=5e-4 * flow.energy.traction_j)
    taken = sum(link.joules for link in links if link.source == LINE)
    back = sum(link.joules for link in links if link.target == BACK)
    assert taken - back == pytest.approx(flow.energy.net_j, rel=1e-3)


@pytest.mark.parametrize("width", [340.0, 900.0])
def test_the_svg_stays_within_its_width_and_says_its_numbers(flow: EnergyFlow, width: float) -> None:
    markup = sankey(flow, LIGHT, width, "Energy")
    svg = ElementTree.fromstring(markup[markup.index("<svg") : markup.index("</svg>") + 6])
    assert svg.get("role") == "img"
    name = "{http://www.w3.org/2000/svg}"
    assert len(svg.findall(f"{name}path")) >= len(links_of(flow))
    for link in links_of(flow):
        assert f"{link.source} to {link.target}" in (svg.get("aria-label") or "")
    starts = [float(x) for x in re.findall(r'<(?:rect|text) x="([-0-9.]+)"', markup)]
    assert min(starts) >= 0
    assert max(starts) < width
