import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.pages.line.model import StationModel
from railjoule.dashboard.pages.line.page import WholeLines
from railjoule.dashboard.workbench import Workbench

TEN = "metro-10-stations"


@pytest.fixture
def model() -> WholeLines:
    """A model of ten stations, without the work that lets it follow the scenario."""
    model = WholeLines(Workbench())
    model.desk.scenario.choose(TEN)
    model.take(model.desk.scenario.edited)
    return model


def station_of(model: WholeLines, name: str) -> StationModel:
    """Return a station as the scenario has it now."""
    model.take(model.desk.scenario.edited)
    return next(station for station in model.inner_stations if station.station == name)


def test_stations_are_those_between_the_ends(model: WholeLines) -> None:
    assert [station.station for station in model.inner_stations][:2] == ["Old Town", "Market"]
    assert [station.dwell_s for station in model.inner_stations][:2] == [25, 30]
    assert len(model.inner_stations) == 8
    model.desk.scenario.choose("liashenko-ii")
    model.take(model.desk.scenario.edited)
    assert model.inner_stations == []


def test_an_arrival_is_free_fixed_or_has_a_window_as_the_scenario_says(model: WholeLines) -> None:
    model.edit(
        {
            1: {"earliest_arrival_s": 200.0, "latest_arrival_s": 200.0},
            2: {"latest_arrival_s": 340.0},
            3: {"earliest_arrival_s": 440.0},
        }
    )
    market, university, hospital = (station_of(model, name) for name in ("Market", "University", "Hospital"))
    assert (market.earliest_s, market.latest_s) == (200, 200)
    assert (university.earliest_s, university.latest_s) == (None, 340)
    assert (hospital.earliest_s, hospital.latest_s) == (440, None)
    central = station_of(model, "Central")
    assert (central.earliest_s, central.latest_s) == (None, None)


def test_what_is_set_at_a_station_comes_back_from_the_file(model: WholeLines) -> None:
    market = station_of(model, "Market")
    market.param.update(dwell_s=33.0, earliest_s=190.0, latest_s=205.5, given_s=201.0)
    model.edit({market.number: market.row})
    stations = {station.name: station for station in model.desk.scenario.edited.line.stations}
    told = stations["Market"].model_dump(exclude={"name", "position_m"})
    assert told == {"dwell_s": 33, "arrival_s": 201, "earliest_arrival_s": 190, "latest_arrival_s": 205.5}
    market.param.update(earliest_s=199.0, latest_s=199.0)
    model.edit({market.number: market.row})
    assert model.desk.scenario.edited.line.stations[2].window_s == (199, 199)


def test_no_end_of_a_window_passes_the_other(model: WholeLines) -> None:
    market = station_of(model, "Market")
    market.param.update(earliest_s=190.0, latest_s=205.5)
    with pytest.raises(ValueError, match=r"At most 205\.5\."):
        market.parse_or_none("earliest_s", "206")
    with pytest.raises(ValueError, match=r"At least 190\."):
        market.parse_or_none("latest_s", "3:09")
    assert market.parse_or_none("latest_s", " ") is None
    with pytest.raises(ValueError, match="not a time"):
        market.parse_or_none("dwell_s", "")


def test_times_that_are_as_in_the_file_again_are_no_change(model: WholeLines) -> None:
    model.edit({1: {"latest_arrival_s": 205.0}})
    assert set(model.desk.scenario.edits) == {"line.stations"}
    model.edit({1: {"latest_arrival_s": None}})
    assert model.desk.scenario.edits == {}


def test_a_time_out_of_its_bounds_changes_nothing(model: WholeLines) -> None:
    with pytest.raises(ScenarioError, match="lies before earliest_arrival_s"):
        model.edit({1: {"earliest_arrival_s": 300.0, "latest_arrival_s": 200.0}})
    assert model.desk.scenario.edits == {}


@pytest.mark.parametrize("reverse", [False, True])
def test_times_reach_their_station_on_a_reversed_line_too(model: WholeLines, reverse: bool) -> None:
    model.desk.scenario.edit({"line.reverse": reverse})
    model.edit({station_of(model, "Market").number: {"dwell_s": 77.0, "arrival_s": 200.0}})
    stations = {station.name: station for station in model.desk.scenario.edited.line.stations}
    assert (stations["Market"].dwell_s, stations["Market"].arrival_s) == (77, 200)
    assert (stations["Central"].dwell_s, stations["Central"].arrival_s) == (40, None)
    assert station_of(model, "Market").given_s == 200


def linked(**values: object) -> dict[str, object]:
    """Return a station as a link of the page had it that kept fixed arrivals beside the scenario."""
    market = {"number": 1, "station": "Market", "position_m": 1950.0, "dwell_s": 30.0, "fixed": False, "arrival_s": 0.0}
    return {**market, **values}


def test_a_link_that_fixes_an_arrival_fixes_it_in_the_scenario(model: WholeLines) -> None:
    old_town = linked(number=0, station="Old Town", position_m=1150.0)
    model.lay({"stations": [old_town, linked(fixed=True, arrival_s=201.5)], "other": "equal"})
    assert model.other == "equal"
    assert [station.window_s for station in model.desk.scenario.edited.line.stations[1:3]] == [
        (0, float("inf")),
        (201.5, 201.5),
    ]
    # the scenario says it from now on
    assert model.keep() == {"stations": [], "other": "equal"}


def test_a_link_that_fixes_no_arrival_changes_nothing(model: WholeLines) -> None:
    model.lay({"stations": [linked()]})
    assert model.desk.scenario.edits == {}


def test_a_link_that_fixes_an_arrival_elsewhere_is_told(model: WholeLines) -> None:
    with pytest.raises(ValueError, match="no station at 1960 m to fix an arrival at"):
        model.lay({"stations": [linked(position_m=1960.0, fixed=True)]})
