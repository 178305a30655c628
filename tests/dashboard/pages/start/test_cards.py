import re
from dataclasses import replace

import pytest

from railjoule.core.scenario import preset_names
from railjoule.dashboard.pages.start.cards import HEIGHT, WIDTH, card_html, hero, picture
from railjoule.dashboard.pages.start.compute import card_names, compute_cards
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


def test_every_shipped_scenario_has_one_card() -> None:
    assert sorted(card_names()) == sorted(preset_names("scenarios"))
    steps = list(compute_cards(("metro-10-stations", "liashenko-ii")))
    assert [[card.run is not None for card in cards] for cards in steps] == [[True, False], [True, True]]
    assert "Being computed" in card_html(steps[0][1])
    text = card_html(steps[-1][0])
    assert "10.40\u00a0km, 8 stations on the way" in text
    assert "Metro 81-7036, 5 cars" in text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        # energies and times as `railjoule solve` has them
        ("tram-950m", "Four phases: 1.053 kWh in 95.0 s"),
        ("kharkiv-like-20kmh", "Set speeds: 5.95 kWh in 418.9 s (timetable 414.7 s)"),
        ("liashenko-ii", "2.223 kWh in 133.7 s"),
    ],
)
def test_a_card_shows_the_run_that_drive_shows(name: str, words: str) -> None:
    ((card,),) = compute_cards((name,))
    assert re.findall(r"<p>(.*?)</p>", card_html(card))[-1].replace("\u00a0", " ") == words


@pytest.fixture(scope="module")
def runs():
    return compute_runs(RunsRequest(Workbench().scenario.scenario(), ("optimal", "fastest")))


def test_the_picture_is_drawn_from_the_optimum(runs) -> None:
    text = hero(runs)
    # 7.81 kWh in 170 s, as `railjoule solve metro-with-limit` has it
    assert "7.81 kWh" in text
    assert "170.0 s" in text
    assert 'role="img" aria-label="Speed over distance of the optimum of Metro, profile II + I: full power' in text


def test_the_picture_stays_in_its_frame(runs) -> None:
    drawn = picture(runs.best, runs.runs["fastest"])
    points = [tuple(map(float, pair.split(","))) for pair in re.findall(r"[\d.]+,[\d.]+", drawn)]
    assert len(points) > 100
    assert all(0 <= x <= WIDTH + 0.05 and 0 <= y <= HEIGHT + 0.05 for x, y in points)


def test_texts_of_a_scenario_are_escaped(runs) -> None:
    run = replace(runs.best, scenario=runs.best.scenario.model_copy(update={"title": "<img src=x>"}))
    text = hero(replace(runs, runs={"optimal": run}))
    assert "<img" not in text
    assert "&lt;img" in text
