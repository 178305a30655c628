import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.dashboard.keep.dropped import embedded, scenario_in_report

HOSTILE = "a \"quoted\" \\ </script><script>alert('1')</script> <!-- \u00e9 &lt;"


@pytest.mark.parametrize("title", [HOSTILE, "", "plain", '\\"</script', "<" * 200])
def test_a_scenario_comes_back_as_it_was(title: str) -> None:
    scenario = load_scenario("metro-with-limit", {"title": title, "vehicle.load_factor": 0.37})
    page = f"<html><body>{embedded(format_scenario(scenario))}<p>more</p></body></html>"
    assert parse_scenario(scenario_in_report(page, "report.html")) == scenario


def test_no_text_can_end_the_element() -> None:
    element = embedded(format_scenario(load_scenario("liashenko-0", {"title": HOSTILE})))
    assert element.count("</script") == 1
    assert element.count("<") == 2


@pytest.mark.parametrize("page", ["", "<html></html>", '<script type="application/toml" id="scenario">\ntitle = ""'])
def test_a_page_without_a_scenario_says_so(page: str) -> None:
    with pytest.raises(ScenarioError, match="not a report of railjoule"):
        scenario_in_report(page, "report.html")
