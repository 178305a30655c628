"""The worth of a run in words, and the card that is printed of it."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from markup import plain

from railjoule.core import Trajectory, load_scenario, solve
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.drive.texts import driver_card, worth, yearly_saving

HOSTILE = "<img src=x onerror=alert(1)>"
NUMBERS = (0.15, 300.0, 0.3)


@pytest.fixture(scope="module")
def optimum() -> Trajectory:
    return solve(load_scenario("metro-with-limit"))


def test_the_saving_against_the_fastest_run(optimum: Trajectory) -> None:
    fastest = solve(load_scenario("metro-with-limit"), "fastest")
    text = plain(worth(optimum, fastest, "Fastest run", None, *NUMBERS))
    energy_mwh, money, _ = yearly_saving(fastest.energy_kwh - optimum.energy_kwh, 300, 0.15, 0.3)
    assert text.startswith("Saved a year Energy, 19.6")
    assert f"{plain(words.number(energy_mwh, 0))} MWh" in text
    assert f"price {plain(words.number(money, 0))} " in text
    assert text.endswith("Fastest run: 36.4 s earlier.")


def test_a_late_run_is_late_and_saves_nothing(optimum: Trajectory) -> None:
    late = replace(optimum, time_s=optimum.time_s * 1.01)
    assert plain(worth(late, optimum, "Pinned run", None, *NUMBERS)) == "This run is 1.7 s late: that saves nothing."
    assert plain(worth(optimum, late, "Pinned run", None, *NUMBERS)) == "Pinned run: 1.7 s late, not comparable."


def test_without_a_baseline_there_is_a_reason(optimum: Trajectory) -> None:
    assert plain(worth(optimum, None, "Pinned run", None, *NUMBERS)) == "Pin a run first."
    assert plain(worth(optimum, None, "Set speeds", None, *NUMBERS)) == "Computing ..."
    refused = worth(optimum, None, "Set speeds", "needs a line without neutral sections.", *NUMBERS)
    assert plain(refused) == "Set speeds: needs a line without neutral sections."


@pytest.mark.parametrize("name", ["metro-with-limit", "metro-10-stations"])
def test_the_card_has_every_instruction_with_its_time_and_loads_nothing(name: str) -> None:
    run = solve(load_scenario(name, {"title": HOSTILE}))
    card = driver_card(run, "A note.")
    items = re.findall(r"<li><b>(\d+)</b><span>([\d:.]+)</span>([^<]+)</li>", card)
    texts = list(words.advice_in_words(run.advice))
    assert [text.lower() for _, _, text in items] == [text.lower() for text in texts]
    assert items[0][1] == "0:00"
    assert "<img" not in card
    assert not re.search(r"(src|href)=|https?:|url\(", card.replace("&lt;img src=x", ""))
    for line in ElementTree.fromstring(card[card.index("<svg") : card.index("</svg>") + 6]).iter("polyline"):
        places = [float(point.split(",")[0]) for point in str(line.get("points")).split()]
        assert (places[0], places[-1]) == (0.0, 1000.0)
    assert "A note." in card


def test_a_year_of_savings() -> None:
    # 2 kWh, 100 trains a day: 200 kWh a day, 73 MWh a year
    assert yearly_saving(2.0, 100, 0.2, 0.4) == pytest.approx((73.0, 14_600.0, 29.2))
    assert yearly_saving(-2.0, 100, 0.2, 0.4) == pytest.approx((-73.0, -14_600.0, -29.2))
    assert yearly_saving(2.0, 0, 0.2, 0.4) == (0.0, 0.0, 0.0)
