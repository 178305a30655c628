"""Scenarios as TOML files: what can be read, and what is said about the rest."""

import math
from pathlib import Path

import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, load_scenario, save_scenario
from railjoule.core.scenario import format_scenario, parse_scenario, preset_names
from railjoule.core.scenario.text_file import MAX_FILE_BYTES, read_text


def test_a_file_gives_what_was_saved(tmp_path):
    scenario = plain_scenario({"title": "Zürich HB, Örlikon", "vehicle.load_factor": 1 / 3})
    save_scenario(scenario, tmp_path / "run.toml")
    assert load_scenario(tmp_path / "run.toml") == scenario
    assert load_scenario(str(tmp_path / "run.toml")) == scenario


@pytest.mark.parametrize("name", preset_names("scenarios"))
def test_a_shipped_scenario_is_found_by_its_name(name):
    assert load_scenario(name).title


def test_a_file_goes_before_a_shipped_scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_scenario(plain_scenario({"title": "mine"}), "liashenko-ii")
    assert load_scenario("liashenko-ii").title == "mine"


def test_changes_are_laid_over_a_file(tmp_path):
    save_scenario(plain_scenario(), tmp_path / "run.toml")
    changed = load_scenario(tmp_path / "run.toml", {"vehicle.load_factor": 0.25, "line.reverse": True})
    assert (changed.vehicle.load_factor, changed.line.reverse) == (0.25, True)


def test_a_byte_order_mark_is_no_error(tmp_path):
    (tmp_path / "run.toml").write_text(format_scenario(plain_scenario()), encoding="utf-8-sig")
    assert load_scenario(tmp_path / "run.toml") == plain_scenario()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("title = ", "broken.toml: not a valid TOML file: "),
        ("[vehicle\n", "broken.toml: not a valid TOML file: "),
        ("title = 'a'\ntitle = 'b'", "broken.toml: not a valid TOML file: "),
        ("travel_time_s = " + "9" * 5000, "broken.toml: not a valid TOML file: a number in it has too many digits."),
        ("x = " + "[" * 5000 + "]" * 5000, "broken.toml: not a valid scenario: its tables or lists are nested too"),
        ("[line." + ".".join("a" * 3000) + "]", "broken.toml: not a valid scenario: a key in line 1 has more"),
        ("", "broken.toml: vehicle is missing (and 2 more)."),
        ("title = 2025-01-01", "broken.toml: title = datetime.date(2025, 1, 1) must be a text"),
    ],
    ids=["no value", "no bracket", "twice", "many digits", "deep lists", "deep tables", "empty", "a date"],
)
def test_a_broken_file(tmp_path, text, sentence):
    (tmp_path / "broken.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError) as error:
        load_scenario(tmp_path / "broken.toml")
    assert str(error.value).startswith(sentence)
    assert "\n" not in str(error.value)


def test_not_a_number_in_a_file(tmp_path):
    text = format_scenario(plain_scenario()).replace("travel_time_s = 150.0", "travel_time_s = nan")
    (tmp_path / "nan.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"^nan.toml: timetable.travel_time_s = nan must be a finite number.$"):
        load_scenario(tmp_path / "nan.toml")


def test_a_hexadecimal_number_of_many_digits(tmp_path):
    text = format_scenario(plain_scenario()).replace("travel_time_s = 150.0", "travel_time_s = 0x" + "F" * 6000)
    (tmp_path / "hex.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError, match="travel_time_s = a number of very many digits must be a number"):
        load_scenario(tmp_path / "hex.toml")


def test_a_file_over_ten_megabytes(tmp_path):
    with (tmp_path / "huge.toml").open("wb") as file:
        file.truncate(MAX_FILE_BYTES + 1)
    with pytest.raises(ScenarioError, match=r"^huge.toml: larger than the 10 MB permitted.$"):
        load_scenario(tmp_path / "huge.toml")
    with pytest.raises(ScenarioError, match="10 MB"):
        parse_scenario(" " * (MAX_FILE_BYTES + 1))


def test_ten_megabytes_are_read(tmp_path):
    (tmp_path / "large.txt").write_bytes(b" " * MAX_FILE_BYTES)
    assert len(read_text(tmp_path / "large.txt")) == MAX_FILE_BYTES


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no such device")
def test_a_device_without_an_end():
    with pytest.raises(ScenarioError, match="10 MB"):
        load_scenario("/dev/zero")


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("no-such-file.toml", "no-such-file.toml: there is no such file."),
        (".", "Is a directory"),
        ("a" * 5000, "File name too long"),
        ("a\0b", "not a valid file name"),
    ],
    ids=["missing", "folder", "long", "zero byte"],
)
def test_a_path_that_leads_nowhere(path, sentence):
    with pytest.raises(ScenarioError) as error:
        load_scenario(path)
    assert sentence in str(error.value)
    assert len(str(error.value)) < 300


def test_text_that_is_none(tmp_path):
    (tmp_path / "bytes.toml").write_bytes(b"title = '\xff\xfe'")
    with pytest.raises(ScenarioError, match=r"^bytes.toml: not UTF-8 text.$"):
        load_scenario(tmp_path / "bytes.toml")


def test_the_time_of_an_average_speed():
    scenario = plain_scenario({"timetable.average_speed_kmh": 36.0})
    assert math.isclose(scenario.travel_time_s, 200.0)  # 2000 m at 10 m/s


def test_the_train_s_length_is_deducted_from_each_inter_station_run():
    """(X_sum - X_tr) / v_sr of Shtompel 2025, (15): 2304 m at 40 km/h."""
    assert math.isclose(load_scenario("kharkiv-like-40kmh").travel_time_s, 207.36)
    changes = {"timetable.average_speed_kmh": 36.0, "timetable.deduct_train_length": True, "vehicle.length_m": 50.0}
    one = plain_scenario({**changes, "line.stations": [{"position_m": 800.0}]})
    assert math.isclose(one.travel_time_s, 190.0)
    assert "the line less the train's length of 50 m for each inter-station run" in one.time_note
    assert "take 190.0 s; the whole line, 200.0 s." in one.time_note
    # a time that is given takes the place of both keys
    assert not one.replace(**{"timetable.travel_time_s": 210.0}).time_note


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"vehicle.length_m": None}, "timetable.deduct_train_length = true needs vehicle.length_m"),
        ({"vehicle.length_m": 800.0}, "the shortest has 800 m, and vehicle.length_m = 800"),
    ],
)
def test_a_train_that_cannot_be_deducted(changes, expected):
    given = {"timetable": {"average_speed_kmh": 36.0, "deduct_train_length": True}}
    with pytest.raises(ScenarioError, match=expected):
        plain_scenario({**given, "line.stations": [{"position_m": 800.0}], **changes})
