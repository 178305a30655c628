import tomllib

import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.models.dropped import scenario_text
from railjoule.dashboard.report.embedded import embedded

TOML = 'title = "<b>x</b>"\n[timetable]\ntravel_time_s = 100'


def test_a_scenario_file_is_taken_as_it_is() -> None:
    assert scenario_text("\ufeff" + TOML, "x.toml") == TOML


def test_a_report_carries_its_scenario() -> None:
    report = f"<!DOCTYPE html><html><head><script>1 < 2</script></head><body>{embedded(TOML)}</body></html>"
    assert tomllib.loads(scenario_text(report, "report.html")) == tomllib.loads(TOML)


def test_another_page_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"^news\.html: no report of railjoule: it holds no scenario\."):
        scenario_text("<html><script>1</script></html>", "news.html")
