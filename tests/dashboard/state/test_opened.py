import pytest

from railjoule.core import InfeasibleLineError, RailjouleError, ScenarioError, load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.limits import LONGEST_TEXT
from railjoule.dashboard.state import draft
from railjoule.dashboard.state.draft import open_scenario

GOOD = format_scenario(load_scenario("liashenko-ii"))


def test_a_text_is_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def parse(text: str, source: str) -> object:
        read.append(text)
        raise ScenarioError(f"{source}: no.")

    monkeypatch.setattr(draft, "parse_scenario", parse)
    draft.try_opening.cache_clear()
    for name in ("one.toml", "another.toml"):
        with pytest.raises(ScenarioError, match=f"^{name}: no\\.$"):
            open_scenario("text", name)
    assert read == ["text"]
    draft.try_opening.cache_clear()


def test_what_is_kept_gives_the_scenario_again() -> None:
    found = open_scenario(GOOD, "x")
    assert found.scenario == load_scenario("liashenko-ii")
    assert open_scenario(found.toml, "x").scenario == found.scenario


SECTIONS = ", ".join(["{length_m = 5.0}"] * 5001)


@pytest.mark.parametrize(
    ("text", "error", "sentence"),
    [
        ("#" * (LONGEST_TEXT + 1), ScenarioError, "x: more than the limit of 2 MB."),
        (
            GOOD + "\n[solver]\nmesh_m = 0.05\n",
            ScenarioError,
            "x: solver.mesh_m = 0.05 makes 26,006 cells; the page takes at most 20,000. Use 0.066 m or more.",
        ),
        (
            GOOD.replace('preset = "liashenko-ii"', f"sections = [{SECTIONS}]"),
            ScenarioError,
            "x: line.sections has 5,001 entries; the page takes at most 5,000.",
        ),
        (
            GOOD.replace('preset = "liashenko-ii"', "sections = [{length_m = 900, gradient_permille = 190}]"),
            InfeasibleLineError,
            "x: At 0 m, on a gradient of 190 per mille, the train comes to a stand",
        ),
    ],
    ids=["long", "fine mesh", "many sections", "steep"],
)
def test_what_no_page_opens(text: str, error: type[RailjouleError], sentence: str) -> None:
    with pytest.raises(error) as refusal:
        open_scenario(text, "x")
    assert str(refusal.value).startswith(sentence)


def test_memory_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def parse(text: str, source: str) -> object:
        raise MemoryError

    monkeypatch.setattr(draft, "parse_scenario", parse)
    draft.try_opening.cache_clear()
    with pytest.raises(ScenarioError, match=r"^x: not enough memory on the server to read it\.$"):
        open_scenario("text", "x")
    draft.try_opening.cache_clear()
