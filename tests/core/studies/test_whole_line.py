"""A whole line: the optimum shares its time with one price of a second, and nothing beats it."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import ScenarioError, TimetableError, load_scenario
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.line_parts import cut_part, stop_nodes
from railjoule.core.strategies.optimal import unwindowed_optimum
from railjoule.core.studies.whole_line import WholeLine, shared_line, whole_line
from railjoule.core.task import prepare_task

SHARINGS = ("optimum", "proportional", "equal")


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """The shipped line over a coarser mesh, with auxiliaries."""
    changes = {"solver.mesh_m": 10.0, "vehicle.auxiliary_power_kw": 50.0}
    return load_scenario("metro-10-stations").replace(**changes)


@pytest.fixture(scope="module")
def lines(scenario: Scenario) -> dict[str, WholeLine]:
    return {sharing: whole_line(scenario, sharing) for sharing in SHARINGS}


@pytest.mark.parametrize("sharing", SHARINGS)
def test_times_and_energies_add_up(scenario, lines, sharing):
    line = lines[sharing]
    assert line.run.travel_time_s == pytest.approx(1080, abs=1e-3)
    running = sum(leg.running_time_s for leg in line.legs)
    # the dwells of the file: 7 of 25, 30 and 40 s, less one each
    assert running == pytest.approx(1080 - 220, abs=1e-3)
    standing_j = 220 * 50e3
    assert sum(leg.energy_j for leg in line.legs) + standing_j == pytest.approx(line.run.energy.net_j, rel=1e-9)
    assert line.run.energy.imbalance == pytest.approx(0, abs=1e-9)
    assert [leg.departs_from for leg in line.legs[1:]] == [leg.arrives_at for leg in line.legs[:-1]]
    assert line.legs[0].departs_from == "Harbour"
    assert line.legs[-1].arrives_at == "Hill"


def test_the_optimum_needs_least_and_has_one_price(scenario, lines):
    energies = {sharing: line.run.energy_kwh for sharing, line in lines.items()}
    assert energies["optimum"] < min(energies["proportional"], energies["equal"])
    assert len({leg.price_of_time_w for leg in lines["optimum"].legs}) == 1
    # the multiplier is the slope of the energy: a second more, solved anew
    later = whole_line(scenario.replace(**{"timetable.travel_time_s": 1081.0})).run
    price = lines["optimum"].legs[0].price_of_time_w
    assert lines["optimum"].run.energy.net_j - later.energy.net_j == pytest.approx(price, rel=0.02)


def test_each_leg_alone_has_the_same_price_in_its_share_of_the_optimum(scenario, lines):
    task, line = prepare_task(scenario), lines["optimum"]
    stops = stop_nodes(task)
    for k in (0, 4):
        leg = line.legs[k]
        alone = unwindowed_optimum(cut_part(task, stops[k], stops[k + 1], leg.running_time_s))
        assert alone.energy.net_j == pytest.approx(leg.energy_j, rel=1e-5)
        assert alone.price_of_time_w == pytest.approx(leg.price_of_time_w, rel=1e-3)


def test_supplements_are_shared_as_named(lines):
    shares = [leg.supplement_s / leg.shortest_time_s for leg in lines["proportional"].legs]
    assert shares == pytest.approx([shares[0]] * 9, rel=1e-5)
    supplements = [leg.supplement_s for leg in lines["equal"].legs]
    assert supplements == pytest.approx([supplements[0]] * 9, rel=1e-5)


def test_a_fixed_arrival_is_kept_and_costs(scenario, lines):
    fixed = shared_line(prepare_task(scenario), "optimum", {4: 530.0})
    assert fixed.legs[4].arrival_s == pytest.approx(530, abs=1e-3)
    assert fixed.run.energy_kwh > lines["optimum"].run.energy_kwh
    # over the mesh of 10 m
    assert 0 < fixed.run.gap < 1e-3
    prices = np.array([leg.price_of_time_w for leg in fixed.legs])
    assert np.ptp(prices[:5]) == np.ptp(prices[5:]) == 0
    assert prices[0] > prices[-1]


def test_fixing_the_optimum_s_own_arrival_costs_nothing(scenario, lines):
    fixed = whole_line(scenario, "optimum", {2: lines["optimum"].legs[2].arrival_s})
    assert fixed.run.energy_kwh == pytest.approx(lines["optimum"].run.energy_kwh, rel=1e-6)


def test_what_cannot_be_kept_is_told(scenario):
    with pytest.raises(ScenarioError, match=r"arrival at Central after 300\.0 s must be later than \d+\.\d s"):
        whole_line(scenario, "equal", {4: 300.0})
    with pytest.raises(ScenarioError, match="no station 8 between the ends of a line with 8 stations"):
        whole_line(scenario, "equal", {8: 300.0})
    with pytest.raises(TimetableError):
        whole_line(scenario.replace(**{"timetable.travel_time_s": 800.0}))


def test_a_line_without_stations_is_one_leg():
    scenario = load_scenario("liashenko-ii")
    line = whole_line(scenario, "proportional")
    assert len(line.legs) == 1
    over_its_mesh = unwindowed_optimum(replace(prepare_task(scenario), can_be_remeshed=False))
    assert line.run.energy_kwh == pytest.approx(over_its_mesh.energy_kwh, rel=1e-9)


def test_a_reversed_line_names_its_stations_as_it_meets_them(scenario):
    line = whole_line(scenario.replace(**{"line.reverse": True}))
    assert [line.legs[0].departs_from, line.legs[0].arrives_at] == ["Hill", "Mills"]
    assert len(line.to_dataframe()) == 9
