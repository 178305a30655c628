"""Names of a user's own files."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario.file_names import LONGEST_NAME, checked_name, same_name_key


@pytest.mark.parametrize("name", ["my-metro", "Örlikon 2", "線 1", "a" * LONGEST_NAME, "it's (a & b)", "म 3 मी"])
def test_a_name_stays_as_it_is(name):
    assert checked_name(name) == name


def test_spaces_around_a_name_go_and_its_marks_are_composed():
    assert checked_name("  Zu\u0308rich ") == "Z\u00fcrich"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("", "name is empty"),
        ("   ", "name is empty"),
        ("../canary", "name = '../canary' must not have '.'"),
        ("a/b", "must not have '/'"),
        ("a\\b", r"must not have '\\'"),
        ("/etc/passwd", "must not have '/'"),
        ("a\0b", r"must not have '\x00'"),
        ("a\nb", r"must not have '\n'"),
        (".hidden", "must not have '.'"),
        ("metro.toml", "must not have '.'"),
        ("C:metro", "must not have ':'"),
        ("metro\u202elmot", r"must not have '\u202e'"),
        ("me\u200btro", r"must not have '\u200b'"),
        ("\ud800", r"must not have '\ud800'"),
        ("-set", "must begin with a letter or a digit"),
        ("Con", "Windows reserves it"),
        ("lpt1", "Windows reserves it"),
        ("a" * 1000, "is too long: 1000 characters of at most 80"),
        ("線" * 80, "is too long: 80 characters of at most 80, in UTF-8 at most 200 bytes"),
    ],
)
def test_a_name_that_is_refused(name, sentence):
    with pytest.raises(ScenarioError) as error:
        checked_name(name)
    assert sentence in str(error.value)
    assert str(error.value).isprintable()
    assert len(str(error.value)) < 250


def test_names_that_a_file_system_could_take_for_one():
    assert same_name_key("Metro") == same_name_key("METRO")
    assert same_name_key("Stra\u00dfe") == same_name_key("strasse")
    assert same_name_key("\uff4detro") == same_name_key("metro")
    assert same_name_key("metro 1") != same_name_key("metro 2")
