import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.pages.set_speeds.page import SetSpeeds
from railjoule.dashboard.pages.set_speeds.sections import even_borders
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def model() -> SetSpeeds:
    model = SetSpeeds(Workbench())
    model.take(load_scenario("kharkiv-like-40kmh"))
    return model


def test_the_sections_of_a_file_are_taken_over(model: SetSpeeds) -> None:
    assert model.borders_m == (1200.0,)
    assert model.found
    assert load_scenario("kharkiv-like-40kmh").replace(**model.changes) == load_scenario("kharkiv-like-40kmh")


def test_a_scenario_without_borders_has_two_halves() -> None:
    model = SetSpeeds(Workbench())
    model.take(load_scenario("liashenko-ii"))
    assert (model.borders_m, model.limits_kmh) == ((650.0,), (80.0, 80.0))


def test_given_limits_of_a_file_are_given() -> None:
    model = SetSpeeds(Workbench())
    model.take(load_scenario("kharkiv-like-40kmh").replace(**{"search.limits_kmh": [50.0, 30.0]}))
    assert not model.found
    assert model.changes["search.limits_kmh"] == [50.0, 30.0]


def test_given_limits_without_borders_are_those_of_the_line() -> None:
    model = SetSpeeds(Workbench())
    scenario = load_scenario("liashenko-i").replace(**{"search.limits_kmh": [50.0] * 6})
    model.take(scenario)
    assert model.limits_kmh == (50.0,) * 6
    assert model.borders_m[0] == scenario.line.sections[0].length_m
    with pytest.raises(ValueError, match="At least 2"):
        model.parse("section_count", "1")


def test_a_cut_line_is_searched_anew(model: SetSpeeds) -> None:
    model.move([50.0, 40.0], [900.0])
    assert not model.found
    assert (model.limits_kmh, model.borders_m) == ((50.0, 40.0), (900.0,))
    model.cut(4)
    assert model.found
    assert model.borders_m == (600.0, 1200.0, 1800.0)


def test_limits_have_the_bounds_of_the_vehicle(model: SetSpeeds) -> None:
    section = model.sections[0]
    assert section.parse("limit_kmh", "80") == 80.0
    with pytest.raises(ValueError, match="At most 80"):
        section.parse("limit_kmh", "81")
    with pytest.raises(ValueError, match="At least 1"):
        section.parse("limit_kmh", "0.5")


@pytest.mark.parametrize(
    ("stops", "count", "expected"),
    [
        ((0.0, 2300.0), 3, [767.0, 1533.0]),
        ((0.0, 5.0), 2, [2.5]),
        ((0.0, 600.5, 2000.0), 3, [600.5, 1300.0]),
        ((0.0, 600.0, 2000.0), 1, []),
    ],
)
def test_borders_are_whole_metres_where_sections_are_long(
    stops: tuple[float, ...], count: int, expected: list[float]
) -> None:
    """Stations are borders where there are enough sections."""
    assert even_borders(stops, count) == expected


def test_a_line_with_stations_has_two_sections_for_each_run() -> None:
    model = SetSpeeds(Workbench())
    model.take(load_scenario("metro-10-stations"))
    assert model.section_count == 18
    assert model.changes["search.inter_station_runs"] == "together"
    assert {1150.0, 1950.0, 8900.0} < set(model.borders_m)
    model.inter_station_runs = "separate"
    assert model.changes["search.inter_station_runs"] == "separate"
    model.found = False
    assert model.changes["search.inter_station_runs"] is None
