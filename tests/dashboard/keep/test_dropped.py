import tomllib

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario.text_file import TomlError
from railjoule.dashboard.keep.dropped import (
    LARGEST_SCENARIO_BYTES,
    TOO_LARGE,
    embedded,
    refused_file,
    scenario_text,
    words_of,
)

TOML = 'title = "<b>x</b>"\n[timetable]\ntravel_time_s = 100'


def test_a_scenario_file_is_taken_as_it_is() -> None:
    assert scenario_text("\ufeff" + TOML, "x.toml") == TOML


def test_a_report_carries_its_scenario() -> None:
    report = f"<!DOCTYPE html><html><head><script>1 < 2</script></head><body>{embedded(TOML)}</body></html>"
    assert tomllib.loads(scenario_text(report, "report.html")) == tomllib.loads(TOML)


def test_another_page_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"^news\.html: not a report of railjoule: it contains no scenario\."):
        scenario_text("<html><script>1</script></html>", "news.html")


def test_a_file_that_is_too_large_is_refused() -> None:
    with pytest.raises(
        ScenarioError, match=r"^x\.toml: it is larger than the 2 MB of a scenario or the 10 MB of a report\."
    ):
        scenario_text("#" * (LARGEST_SCENARIO_BYTES + 1), "x.toml")


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        (
            "run.csv",
            "run.csv: it contains no scenario. Only scenarios (.toml) and reports of railjoule (.html) can be opened; ",
        ),
        ("run.XLSX", "into its list in the editor."),
        (
            "notes.txt",
            "notes.txt: it contains no scenario. "
            "Only scenarios (.toml) and reports of railjoule (.html) can be opened.",
        ),
        ("broken.toml", "broken.toml: not a valid TOML file: no."),
        ("report.html", "broken.toml: not a valid TOML file: no."),
    ],
)
def test_what_holds_no_scenario_is_told_what_does(name: str, sentence: str) -> None:
    assert sentence in words_of(TomlError("broken.toml: not a valid TOML file: no."), name)


def test_what_is_wrong_in_a_scenario_is_told_whatever_its_file_is_called() -> None:
    assert words_of(ScenarioError("x.txt: vehicle is missing."), "x.txt") == "x.txt: vehicle is missing."


def test_a_refusal_is_one_sentence_and_what_can_be_opened() -> None:
    assert refused_file("a.csv", TOO_LARGE).count(". ") == 1
