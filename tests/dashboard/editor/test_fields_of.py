import re

import pytest
from name_units import WITHOUT_UNIT, unit_of

from railjoule.core.scenario import Scenario
from railjoule.dashboard.editor.fields_of import Field, Table, model_names, parts_of
from railjoule.dashboard.editor.model import GROUPS
from railjoule.dashboard.look.key_names import split_unit


def all_fields() -> list[Field]:
    """Return all fields of all groups, those of all kinds of drives and of all tables."""
    parts = [part for tables in GROUPS.values() for name in tables if name != "drive" for part in parts_of(name)]
    parts += [part for model in model_names("drive") for part in parts_of("drive", model)]
    return [field for part in parts for field in (part.columns if isinstance(part, Table) else [part])]


def test_units_are_those_that_the_keys_tell() -> None:
    shown = str.maketrans({"\u00b2": "2", "\u00b3": "3"})
    differing = {
        field.name: (field.unit, unit_of(field.name))
        for field in all_fields()
        if field.kind in {"number", "whole", "numbers"}
        and field.name not in WITHOUT_UNIT
        and (field.unit.translate(shown).replace("\u2030", "per mille") or "1") != unit_of(field.name)
    }
    assert differing == {}


def test_every_key_of_the_file_but_those_of_chance_has_a_field() -> None:
    names = {field.name for field in all_fields()}
    wanted = {
        name
        for key, info in Scenario.model_fields.items()
        if key not in {"title", "strategy", "vehicle", "line", "montecarlo"}
        for name in info.annotation.model_fields  # type: ignore[union-attr]
    }
    assert wanted - {"stops", "speed_limits", "voltage_changes", "recuperation_changes", "reserve_parts"} <= names
    assert all(re.fullmatch(r"[A-Z][^_]*", field.label) for field in all_fields())


def test_a_field_says_what_it_means_and_its_bounds() -> None:
    (tare,) = [part for part in parts_of("vehicle") if part.key == "vehicle.tare_kg"]
    assert isinstance(tare, Field)
    assert tare.label == "Tare, kg"
    assert tare.help_words == "Mass of the empty vehicle. Above 0 and at most 10\u202f000\u202f000."


def test_a_field_of_a_time_takes_it_as_on_a_clock() -> None:
    time, *_ = parts_of("timetable")
    assert isinstance(time, Field)
    assert time.parse("2 min 30 s") == time.parse("2:30") == 150.0
    assert time.help_words == (
        "Time for the whole run. Above 0 and at most 86\u202f400 (24:00:00). Also as 2:30 or 2 min 30 s. "
        "Can be left empty."
    )
    steps = {part.key: part for part in parts_of("simulation")}["simulation.time_step_s"]
    assert isinstance(steps, Field)
    assert "2:30" not in steps.help_words


def test_bounds_beside_none_and_within_a_list_are_read() -> None:
    parts = {part.key: part for table in ("vehicle.traction", "search") for part in parts_of(table)}
    effort, boundaries, curve = (
        parts[key] for key in ("vehicle.traction.max_effort_kn", "search.boundaries_m", "vehicle.traction.curve")
    )
    assert isinstance(effort, Field)
    assert (effort.above, effort.most, effort.optional) == (0, 1e4, True)
    assert isinstance(boundaries, Field)
    assert (boundaries.kind, boundaries.above, boundaries.most, boundaries.count) == ("numbers", 0, 1e7, (0, 50))
    assert isinstance(curve, Table)
    assert [(column.least, column.most) for column in curve.columns] == [(0, 600), (0, 1e4)]
    assert (curve.of_lists, curve.fewest, curve.most) == (True, 2, 1000)


def test_a_field_has_the_name_that_the_pages_have() -> None:
    (error,) = [part for part in parts_of("disturbance") if part.key.endswith("coordinate_error_m")]
    assert error.label == "Position error, m"


@pytest.mark.parametrize(
    ("name", "words", "unit"),
    [
        ("travel_time_s", "travel_time", "s"),
        ("quadratic_n_per_kn_per_kmh2", "quadratic", "N/kN/(km/h)\u00b2"),
        ("curve_constant_m_n_per_kn", "curve_constant", "N m/kN"),
        ("linear_n_per_kmh", "linear", "N/(km/h)"),
        ("load_factor", "load_factor", ""),
    ],
)
def test_the_unit_stands_at_the_end_of_a_name(name: str, words: str, unit: str) -> None:
    assert split_unit(name) == (words, unit)
