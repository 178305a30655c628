import pytest

from railjoule.core.scenario import load_scenario
from railjoule.dashboard.editor.fields_of import Field, Table, parts_of
from railjoule.dashboard.editor.model import DRIVE, GROUPS, LINE, VEHICLE, EditorModel
from railjoule.dashboard.state.scenario import ScenarioModel


@pytest.fixture
def model() -> ScenarioModel:
    return ScenarioModel()


@pytest.fixture
def editor(model: ScenarioModel) -> EditorModel:
    return EditorModel(model)


def part(editor: EditorModel, key: str) -> Field | Table:
    scenario = editor.look().now
    return next(
        one for group in GROUPS for _, parts in editor.parts(group, scenario) for one in parts if one.key == key
    )


def field(editor: EditorModel, key: str) -> Field:
    found = part(editor, key)
    assert isinstance(found, Field)
    return found


def table(editor: EditorModel, key: str) -> Table:
    found = part(editor, key)
    assert isinstance(found, Table)
    return found


def test_a_typed_value_is_an_edit_and_typed_back_is_none(model: ScenarioModel, editor: EditorModel) -> None:
    tare = field(editor, "vehicle.tare_kg")
    before = editor.look().text(tare)
    editor.type(tare, "150\u202f000")
    assert dict(model.changes) == {"vehicle.tare_kg": 150_000.0}
    assert (editor.look().text(tare), editor.look().was(tare)) == ("150000", before)
    editor.type(tare, before)
    assert dict(model.changes) == {}


def test_every_field_takes_its_own_text_without_a_change(model: ScenarioModel, editor: EditorModel) -> None:
    look = editor.look()
    for group in GROUPS:
        for _, parts in editor.parts(group, look.now):
            for one in parts:
                if isinstance(one, Field):
                    editor.type(one, look.text(one))
    assert (dict(model.changes), editor.refused) == ({}, {})


@pytest.mark.parametrize(
    ("key", "text", "sentence"),
    [
        ("vehicle.tare_kg", "0", "Above 0. Kept: 160000 kg."),
        ("vehicle.tare_kg", "1e9", "At most 1e+07. Kept: 160000 kg."),
        (
            "vehicle.inertial_mass_kg",
            "100",
            "vehicle.inertial_mass_kg = 100 is below tare_kg = 160000, which it includes. Kept: nothing.",
        ),
        (
            "vehicle.load_factor",
            "1,5",
            "vehicle.load_factor = 1.5 must be at most 1.2, the crush_load_factor. Kept: 0.5.",
        ),
        ("phases.cycles", "2.5", "A whole number. Kept: 1."),
        (
            "timetable.travel_time_s",
            "soon",
            "Travel time: 'soon' is not a time: write seconds, min:s or h:min:s, such as 150, 2:30 or 1:02:03. "
            "Kept: 170 s.",
        ),
        ("vehicle.tare_kg", "soon", "Not a number. Kept: 160000 kg."),
        ("simulation.sensor_errors_m", "1 2", "3 numbers. Kept: 0 0 0 m."),
    ],
)
def test_what_is_no_value_is_refused_and_kept(
    model: ScenarioModel, editor: EditorModel, key: str, text: str, sentence: str
) -> None:
    editor.type(field(editor, key), text)
    assert (editor.refused[key].text, editor.refused[key].sentence) == (text, sentence)
    assert dict(model.changes) == {}


def test_what_does_not_fit_the_rest_is_told_at_the_field(model: ScenarioModel, editor: EditorModel) -> None:
    editor.type(field(editor, "phases.cruise"), "no")
    editor.type(field(editor, "phases.coast"), "no")
    assert editor.refused["phases.coast"].sentence.startswith("phases.cruise and coast cannot both be false")
    assert dict(model.changes) == {"phases.cruise": False}


def test_what_a_preset_gives_cannot_be_left_empty(model: ScenarioModel, editor: EditorModel) -> None:
    editor.type(field(editor, "vehicle.traction.max_power_kw"), "")
    assert "cannot be left empty" in editor.refused["vehicle.traction.max_power_kw"].sentence
    assert dict(model.changes) == {}


def test_vehicle_and_line_are_chosen_apart(model: ScenarioModel, editor: EditorModel) -> None:
    editor.type(VEHICLE, "tram-105n")
    editor.type(LINE, "liashenko-i")
    now = model.scenario()
    assert (now.vehicle.preset, now.line.preset, now.vehicle.load_factor) == ("tram-105n", "liashenko-i", 0.5)
    editor.type(field(editor, "vehicle.tare_kg"), "18000")
    assert editor.look().was(field(editor, "vehicle.tare_kg")) == "16500"
    editor.type(VEHICLE, "metro-81-7036")
    editor.type(LINE, "")
    assert model.scenario().line == load_scenario(model.preset).line
    assert model.scenario().vehicle.drive.model == "constant_efficiency"


@pytest.mark.parametrize("model_name", DRIVE.choices)
def test_every_kind_of_drive_can_be_taken(model: ScenarioModel, editor: EditorModel, model_name: str) -> None:
    recuperation = model.scenario().vehicle.drive.recuperation_factor
    editor.type(DRIVE, model_name)
    assert editor.refused == {}
    drive = model.scenario().vehicle.drive
    assert (drive.model, drive.recuperation_factor) == (model_name, recuperation)
    assert {
        one.key.removeprefix("drive.") for _, parts in editor.parts("Powertrain", model.scenario()) for one in parts
    } >= {name for name, value in drive.model_dump().items() if name != "model" and not isinstance(value, dict)}
    editor.type(DRIVE, "constant_efficiency")
    assert model.scenario().vehicle.drive.model == "constant_efficiency"


def test_cells_rows_and_their_refusals(model: ScenarioModel, editor: EditorModel) -> None:
    sections = table(editor, "line.sections")
    length, count = model.scenario().line.length_m, len(model.scenario().line.sections)
    editor.change_rows(sections, "cell", 1, 1, "\u221225,5")
    assert model.scenario().line.sections[1].gradient_permille == -25.5
    editor.change_rows(sections, "insert", 1)
    assert (len(model.scenario().line.sections), model.scenario().line.length_m) == (count + 1, length)
    editor.change_rows(sections, "remove", 2)
    assert model.scenario().line.length_m == length - 100
    editor.change_rows(sections, "down", 0)
    assert model.scenario().line.sections[0].gradient_permille == -25.5
    editor.change_rows(sections, "cell", 2, 1, "300")
    refusal = editor.refused["line.sections"]
    assert (refusal.row, refusal.column, refusal.text) == (2, 1, "300")
    assert refusal.sentence == "Row 3, Gradient, \u2030: '300'. At most 200. Nothing is changed."
    editor.take_back(sections)
    assert dict(model.changes) == {}


def test_a_block_is_pasted_over_cells_or_over_all(model: ScenarioModel, editor: EditorModel) -> None:
    sections = table(editor, "line.sections")
    editor.change_rows(sections, "paste", 0, 1, "10\t40\n12\t30")
    first, second = model.scenario().line.sections[:2]
    assert (first.gradient_permille, first.speed_limit_kmh, first.length_m) == (10, 40, 150)
    assert (second.gradient_permille, second.speed_limit_kmh) == (12, 30)
    editor.change_rows(sections, "replace", text="length_m,gradient_permille\n1500,2.5\n800,-3\n")
    assert [section.length_m for section in model.scenario().line.sections] == [1500, 800]
    editor.change_rows(sections, "replace", text="100;2\nfar;3")
    assert editor.refused["line.sections"].sentence.startswith("Row 2, Length, m: 'far'. Not a number.")
    assert [section.length_m for section in model.scenario().line.sections] == [1500, 800]


def test_a_line_too_short_for_its_limit_is_refused(model: ScenarioModel, editor: EditorModel) -> None:
    editor.change_rows(table(editor, "line.sections"), "replace", text="500\t1")
    assert "lies beyond the end of the line at 500 m" in editor.refused["line.sections"].sentence
    assert dict(model.changes) == {}


@pytest.mark.parametrize(
    "key",
    [
        "line.speed_limits",
        "line.neutral_sections",
        "line.traction_limits",
        "line.rail_conditions",
        "line.stations",
        "line.passing_points",
        "disturbance.stops",
        "disturbance.speed_limits",
        "disturbance.voltage_changes",
        "disturbance.recuperation_changes",
        "vehicle.traction.curve",
        "vehicle.braking.curve",
        "vehicle.braking.permitted_deceleration",
    ],
)
def test_rows_can_be_added_to_every_table(editor: EditorModel, key: str) -> None:
    one = table(editor, key)
    while editor.look().rows(one):
        editor.change_rows(one, "remove", 0)
    editor.change_rows(one, "insert", 0)
    editor.change_rows(one, "insert", 0)
    assert (editor.refused, len(editor.look().rows(one)) >= 2) == ({}, True)


def test_a_table_of_too_many_rows_is_refused() -> None:
    editor = EditorModel(ScenarioModel())
    table = next(part for part in parts_of("line") if isinstance(part, Table) and part.key == "line.sections")
    editor.change_rows(table, "replace", text="1\n" * 5001)
    assert editor.refused["line.sections"].sentence == "5,001 rows; the page takes at most 5,000. Nothing is changed."
    assert not editor.scenario.edits


def test_a_station_between_two_others_has_no_arrival_of_theirs(editor: EditorModel) -> None:
    stations = table(editor, "line.stations")
    editor.change_rows(stations, "replace", text="name,position_m,dwell_s,latest_arrival_s\nA,700,20,90\nB,1500,20,")
    editor.change_rows(stations, "insert", 0)
    assert editor.refused == {}
    assert editor.look().rows(stations)[1] == {"name": "", "position_m": 1100, "dwell_s": 20}


def test_a_passing_point_is_added_away_from_the_stations(editor: EditorModel) -> None:
    editor.change_rows(table(editor, "line.stations"), "replace", text="position_m\n1150")
    points = table(editor, "line.passing_points")
    editor.change_rows(points, "insert", 0)
    assert editor.refused == {}
    (row,) = editor.look().rows(points)
    assert (row["position_m"], row["speed_kmh"]) in {(575.0, 30.0), (1725.0, 30.0)}


def test_the_rail_condition_is_chosen_and_taken_back(model: ScenarioModel, editor: EditorModel) -> None:
    rails = field(editor, "line.rail_condition")
    assert (rails.optional, rails.choices, editor.look().text(rails)) == (True, ("dry", "wet"), "")
    editor.type(rails, "wet")
    assert dict(model.changes) == {"line.rail_condition": "wet"}
    editor.type(field(editor, "vehicle.adhesion.driven_mass_share"), "1.5")
    assert "At most 1." in editor.refused["vehicle.adhesion.driven_mass_share"].sentence
    editor.type(rails, "")
    assert dict(model.changes) == {}
