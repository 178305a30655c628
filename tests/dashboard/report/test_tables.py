from railjoule.core import Scenario, load_scenario
from railjoule.dashboard.editor.fields_of import Field, parts_of
from railjoule.dashboard.report.tables import MAX_ROWS, FieldRow, scenario_tables


def rows(scenario: Scenario) -> list[list[str]]:
    """Return the rows of all tables, a name with its meaning where the report shows it."""
    found = []
    for table in scenario_tables(scenario):
        for row in table.rows:
            meaning = [row.meaning] if isinstance(row, FieldRow) and row.adds_to_name else []
            cells = [" ".join([row.quantity, *meaning]), row.value, row.unit] if isinstance(row, FieldRow) else [*row]
            found.append(cells)
    return found


def test_quantities_have_their_values_and_units() -> None:
    told = rows(load_scenario("liashenko-ii", {"vehicle.load_factor": 0.5}))
    # 160 t empty, half of 1385 passengers of 74.9745 kg
    assert ["Tare Mass of the empty vehicle.", "160\u202f000", "kg"] in told
    assert ["Mass with passengers", "211\u202f920", "kg"] in told
    assert ["Quadratic Absolute, quadratic in speed.", "1.7463", "N/(km/h)\u00b2"] in told


def test_a_field_has_the_editors_name_and_unit() -> None:
    told = [row for row in rows(load_scenario("tram-950m")) if row]
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
    told = rows(load_scenario("liashenko-0", changes))
    # neither curves nor tunnels: no columns of nothing
    assert ["0", "500", "0.0", "60"] in told
    assert ["500", "800", "\u22124.0", ""] in told


def test_stations_have_columns_for_what_is_given_alone() -> None:
    stations = [{"name": "Middle", "position_m": 400.0, "dwell_s": 20.0}]
    points = [{"name": "Signal", "position_m": 700.0, "speed_kmh": 45.0}]
    neutral = [{"from_m": 150.0, "to_m": 250.0}]
    changes = {"line.stations": stations, "line.passing_points": points, "line.head_wind_kmh": 12.5}
    assert ["150", "250"] in rows(load_scenario("liashenko-0", {"line.neutral_sections": neutral}))
    told = rows(load_scenario("liashenko-0", changes))
    assert ["Middle", "400", "20"] in told
    assert ["Signal", "700", "45"] in told
    assert ["12.5", "km/h"] in [row[1:] for row in told]
    stations[0]["latest_arrival_s"] = 90.5
    assert ["Middle", "400", "20", "90.5"] in rows(load_scenario("liashenko-0", changes))


def test_choices_are_told_in_words() -> None:
    told = rows(load_scenario("liashenko-0", {"vehicle.length_m": 96, "vehicle.gradient_at": "middle"}))
    assert ["Middle"] in [row[1:2] for row in told]
    assert not any("_" in cell for row in told for cell in row)


def test_the_rail_condition_and_the_driven_mass_are_shown() -> None:
    wet = rows(load_scenario("kharkiv-like-40kmh", {"line.rail_condition": "wet"}))
    assert ["Wet"] in [row[1:2] for row in wet]
    assert ["0.6"] in [row[1:2] for row in wet]
    assert any("Rail condition" in row[0] for row in wet)
    assert not any("Rail condition" in row[0] for row in rows(load_scenario("kharkiv-like-40kmh")))


def test_a_long_table_says_how_much_it_leaves_out() -> None:
    sections = [{"length_m": 20.0}] * (MAX_ROWS + 7)
    tables = scenario_tables(load_scenario("liashenko-0", {"line.preset": None, "line.sections": sections}))
    assert [table.left_out for table in tables if table.head] == [7]


def test_undisturbed_scenarios_have_no_table_of_disturbances() -> None:
    titles = [table.title for table in scenario_tables(load_scenario("liashenko-0"))]
    assert not any("Disturb" in title for title in titles)
    disturbed = load_scenario("liashenko-0", {"disturbance.stops": [{"position_m": 400.0, "duration_s": 5.0}]})
    stops = next(table for table in scenario_tables(disturbed) if table.title == "Disturbances: stops")
    assert ("Position, m", "400") in zip(stops.head, stops.rows[0], strict=True)
    assert ("Duration, s", "5") in zip(stops.head, stops.rows[0], strict=True)
