"""The lessons that are played, as the page has them: verdicts, tries, links, and what opens elsewhere."""

import re
from typing import Any

import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.manual import require_drivable
from railjoule.dashboard.app import Session
from railjoule.dashboard.keep.pins import run_again
from railjoule.dashboard.pages.learn.by_hand import PRESET, best_run, driven_run, judge, mesh_arrays
from railjoule.dashboard.pages.learn.verdict import best_try, details, outcome
from railjoule.dashboard.state.pins import KeptPin

POWER, COMMANDS, LATE = "p0", "p0c300p600", "p0c60"
EVEN = ",".join(["60"] * 35)


def opened(**fields: str) -> Any:
    """Return the page of a new session whose link has some fields."""
    session = Session()
    learn = session.state.pages["Learn"]
    learn.param.update(**fields)
    session.state.page = "Learn"
    return learn


@pytest.fixture
def learn() -> Any:
    return opened()


def test_a_try_is_judged_kept_and_counted(learn: Any) -> None:
    lesson = learn.played["driven"]
    assert lesson.verdict == {}
    assert set(lesson.given) == {"mesh", "heights", "timetable_s", "tries", "ghost"}
    for number in (1, 2, 3):
        learn.hear("driven", "done", COMMANDS)
        # the same try again is one more
        assert (lesson.verdict["tried"], lesson.verdict["count"]) == (number, number)
    assert learn.driven == COMMANDS
    assert "Begin again with three tries" in lesson.verdict["head"]
    learn.hear("driven", "reset", "")
    learn.hear("driven", "done", POWER)
    assert lesson.verdict["tried"] == 1
    assert "Drive again (2 left)" in lesson.verdict["head"]
    assert len(lesson.verdict["best_s"]) == len(lesson.given["mesh"]["position"])


def test_a_late_try_is_called_late_and_has_no_share_of_the_bound() -> None:
    early, late = judge(COMMANDS), judge(LATE)
    assert early.counts
    assert not late.counts
    head, table = outcome(late), details(late, [early, late])
    assert re.search(r"You are \d+\.\d s late: this try does not count\. On time, nobody can use less than 7\.81", head)
    assert "more than needed" not in head
    shares = re.findall(r"<tr[^>]*><td>\d</td><td>[\d.]+</td><td>([^<]*)</td>", table)
    assert shares[0].startswith("+")
    assert shares[1] == "\u2013"
    assert best_try([late]) is None
    assert best_try([late, early]) is early


def test_the_first_place_where_the_runs_part_is_named() -> None:
    verdict = judge(POWER)
    assert verdict.sentences[0] == "From 42 m on you differ from the best run: it coasts."
    assert verdict.curves["parting"]["position"] == 42.0
    assert sum(kwh for _, kwh in verdict.rows) == pytest.approx(verdict.curves["above_kwh"][-1], abs=1e-4)


def test_the_try_and_the_optimum_are_pinned_on_drive(learn: Any) -> None:
    learn.hear("driven", "open", COMMANDS)
    desk = learn.desk
    assert (desk.page, desk.scenario.preset) == ("Drive", PRESET)
    best, driven = desk.pins
    assert best.trajectory.energy_kwh == best_run().energy_kwh
    assert driven.trajectory.energy_kwh == judge(COMMANDS).kwh
    assert driven.name.startswith("Driven by hand, ")
    # the same try again is the same pin
    learn.hear("driven", "open", COMMANDS)
    assert len(desk.pins) == 2
    best, driven = run_again(tuple(KeptPin.of(pin) for pin in desk.pins))
    assert driven.trajectory.energy_kwh == driven_run(COMMANDS).energy_kwh


def test_what_was_drawn_or_distributed_opens_where_it_goes_on(learn: Any) -> None:
    learn.hear("shared", "open", "uneven:12,30,18")
    assert (learn.desk.page, learn.desk.scenario.edited.title) == ("Line", "Distribute the supplement: uneven legs")
    learn.hear("drawn", "open", EVEN)
    assert (learn.desk.page, learn.desk.scenario.travel_time_s) == ("Drive", 130.0)


def test_a_link_has_a_run_to_race_and_shows_nothing_of_the_best() -> None:
    learn = opened(driven=COMMANDS)
    assert learn.played["driven"].given["ghost"]["times"][-1] == pytest.approx(driven_run(COMMANDS).travel_time_s)
    assert learn.played["driven"].lead == "driven"
    assert learn.played["driven"].verdict == {}


@pytest.mark.parametrize(
    ("field", "text", "sentence"),
    [
        ("driven", "x1", "letters p, c and b"),
        ("shared", "uneven:1,1,1", "sum to 60"),
        ("drawn", "1,2,3", "35 whole numbers"),
    ],
)
def test_a_wrong_link_is_refused_and_the_lesson_begins_all_the_same(field: str, text: str, sentence: str) -> None:
    learn = opened(**{field: text})
    assert sentence in learn.host.message.object
    assert learn.played[field].given
    right = {"driven": COMMANDS, "shared": "even:19,21,20", "drawn": EVEN}[field]
    learn.hear(field, "done", right)
    assert getattr(learn, field) == right
    assert (learn.verdict.field, learn.verdict.text) == (field, right)


def test_what_cannot_be_judged_is_refused_and_lets_one_go_on(learn: Any) -> None:
    learn.hear("drawn", "done", "<b>60</b>")
    assert "35 whole numbers" in str(learn.failure)
    assert "computed" not in str(learn.played["drawn"].outcome.object)
    learn.hear("drawn", "open", "60")
    assert learn.desk.page == "Learn"
    learn.hear("drawn", "done", EVEN)
    assert learn.failure is None


def test_a_drawing_is_driven_and_typed_and_its_verdict_goes_with_it(learn: Any) -> None:
    lesson = learn.played["drawn"]
    assert "34.2 s to spare" in str(lesson.figures.object)
    lesson.stretch.param.update(start_m=0.0, end_m=1700.0, speed_kmh=60.0)
    lesson.type_speed()
    assert lesson.text == EVEN
    assert learn.sketched.energy_kwh == pytest.approx(36.40, abs=0.005)
    learn.hear("drawn", "done", EVEN)
    # 60 km/h as far as the train can, by `railjoule.core` in test_drawing
    assert "You use 36.40 kWh" in str(lesson.outcome.object)
    assert lesson.above.visible
    lesson.stretch.param.update(end_m=100.0, speed_kmh=30.0)
    lesson.type_speed()
    assert lesson.points[:4] == (30, 30, 30, 60)
    assert "class=outcome" not in str(lesson.outcome.object)
    assert not lesson.above.visible


def test_stations_cannot_be_driven_by_hand() -> None:
    with pytest.raises(ScenarioError, match="without stops on the way"):
        require_drivable(build_meshed_line(load_scenario("metro-10-stations")))


def test_the_lesson_is_for_a_simple_train() -> None:
    with pytest.raises(ScenarioError, match="constant efficiency that only force and power limit"):
        mesh_arrays(build_meshed_line(load_scenario("ftorek-300s")))
