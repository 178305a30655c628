from railjoule.core import load_scenario
from railjoule.dashboard.pages.line.model import LineModel

TEN = "metro-10-stations"


def test_stations_are_those_between_the_ends() -> None:
    model = LineModel()
    model.take(load_scenario(TEN))
    assert [station.station for station in model.stations][:2] == ["Old Town", "Market"]
    assert [station.dwell_s for station in model.stations][:2] == [25, 30]
    assert len(model.stations) == 8
    model.take(load_scenario("liashenko-ii"))
    assert model.stations == []


def test_a_fixed_arrival_stays_while_the_stations_stay() -> None:
    model = LineModel()
    model.take(load_scenario(TEN))
    model.stations[3].param.update(fixed=True, arrival_s=430.0)
    model.take(load_scenario(TEN).with_(**{"vehicle.load_factor": 0.1}))
    assert model.arrivals_s == ((3, 430.0),)


def test_a_dwell_reaches_its_station_on_a_reversed_line_too() -> None:
    for reverse in (False, True):
        scenario = load_scenario(TEN).with_(**{"line.reverse": reverse})
        model = LineModel()
        model.take(scenario)
        market = next(station for station in model.stations if station.station == "Market")
        market.dwell_s = 77.0
        changed = scenario.with_(**model.dwell_changes(scenario))
        dwells = {station.name: station.dwell_s for station in changed.line.stations}
        assert dwells["Market"] == 77
        assert dwells["Central"] == 40
