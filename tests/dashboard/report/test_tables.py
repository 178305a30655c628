import re

from railjoule.core import load_scenario
from railjoule.dashboard.editor.fields_of import Field, parts_of
from railjoule.dashboard.report.tables import MAX_ROWS, scenario_tables


def rows(markup: str) -> list[list[str]]:
    return [
        [re.sub(r"<[^>]+>", "", cell) for cell in row.partition("</table>")[0].split("<td>")[1:]]
        for row in re.split(r"<tr[^>]*>", markup)[1:]
    ]


def test_quantities_have_their_values_and_units() -> None:
    told = rows(scenario_tables(load_scenario("liashenko-ii", {"vehicle.load_factor": 0.5})))
    # 160 t empty, half of 1385 passengers of 74.9745 kg
    assert ["Tare Mass of the empty vehicle.", "160\u202f000", "kg"] in told
    assert ["Mass with passengers", "211\u202f920", "kg"] in told
    assert ["Quadratic Absolute, quadratic in speed.", "1.7463", "N/(km/h)\u00b2"] in told


def test_a_field_has_the_editors_name_and_unit() -> None:
    told = [row for row in rows(scenario_tables(load_scenario("tram-950m"))) if row]
    fields = [field for field in parts_of("drive", "induction") if isinstance(field, Field)]
    of_numbers = [field for field in fields if field.kind in {"number", "whole"}]
    assert len(of_numbers) > 15
    for field in of_numbers:
        assert [f"{field.quantity} {field.meaning}", field.unit] in [[row[0], row[-1]] for row in told]
    assert ["Kind", "Induction", ""] in told
    assert len({tuple(row) for row in told}) == len(told)  # two losses of one value and meaning are told apart


def test_a_line_is_told_in_running_order() -> None:
    sections = [{"length_m": 300.0, "gradient_permille": 4.0}, {"length_m": 500.0, "speed_limit_kmh": 60.0}]
    changes = {"line.preset": None, "line.sections": sections, "line.reverse": True}
    told = rows(scenario_tables(load_scenario("liashenko-0", changes)))
    # neither curves nor tunnels: no columns of nothing
    assert ["0", "500", "0.0", "60"] in told
    assert ["500", "800", "\u22124.0", ""] in told


def test_stations_have_columns_for_what_is_given_alone() -> None:
    stations = [{"name": "Middle", "position_m": 400.0, "dwell_s": 20.0}]
    points = [{"name": "Signal", "position_m": 700.0, "speed_kmh": 45.0}]
    neutral = [{"from_m": 150.0, "to_m": 250.0}]
    changes = {"line.stations": stations, "line.passing_points": points, "line.head_wind_kmh": 12.5}
    assert ["150", "250"] in rows(scenario_tables(load_scenario("liashenko-0", {"line.neutral_sections": neutral})))
    told = rows(scenario_tables(load_scenario("liashenko-0", changes)))
    assert ["Middle", "400", "20"] in told
    assert ["Signal", "700", "45"] in told
    assert ["12.5", "km/h"] in [row[1:] for row in told]
    stations[0]["latest_arrival_s"] = 90.5
    assert ["Middle", "400", "20", "90.5"] in rows(scenario_tables(load_scenario("liashenko-0", changes)))


def test_choices_are_told_in_words() -> None:
    told = rows(
        scenario_tables(load_scenario("liashenko-0", {"vehicle.length_m": 96, "vehicle.gradient_at": "middle"}))
    )
    assert ["Middle"] in [row[1:2] for row in told]
    assert not any("_" in cell for row in told for cell in row)


def test_the_rail_condition_and_the_driven_mass_are_shown() -> None:
    wet = scenario_tables(load_scenario("kharkiv-like-40kmh", {"line.rail_condition": "wet"}))
    assert ["Wet"] in [row[1:2] for row in rows(wet)]
    assert ["0.6"] in [row[1:2] for row in rows(wet)]
    assert "Rail condition" in wet
    assert "Rail condition" not in scenario_tables(load_scenario("kharkiv-like-40kmh"))


def test_a_long_table_says_how_much_it_leaves_out() -> None:
    sections = [{"length_m": 20.0}] * (MAX_ROWS + 7)
    markup = scenario_tables(load_scenario("liashenko-0", {"line.preset": None, "line.sections": sections}))
    assert "7 more rows in the scenario that this file carries." in markup


def test_what_goes_as_planned_is_not_told() -> None:
    assert "otherwise" not in scenario_tables(load_scenario("liashenko-0"))
    stop = [{"position_m": 400.0, "duration_s": 5.0}]
    told = scenario_tables(load_scenario("liashenko-0", {"disturbance.stops": stop}))
    assert "Event: stop 1" in told
    assert ["Duration Duration of the stop.", "5", "s"] in rows(told)
