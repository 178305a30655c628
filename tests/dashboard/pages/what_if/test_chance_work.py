"""The work of the tab "Chance", done in the test's own turn."""

import numpy as np
import pytest

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.what_if.page import WhatIf
from railjoule.dashboard.workbench import Workbench


@pytest.fixture(scope="module")
def model() -> WhatIf:
    state = Workbench()
    state.scenario.choose("liashenko-0")
    PageWorks(state.pages["What if"])
    found: WhatIf = state.pages["What if"]
    found.tab = "chance"
    state.page = "What if"
    return found


def test_another_position_leaves_the_draws(model: WhatIf) -> None:
    chance = model.chance
    model.desk.day.coordinate_error_m = -7.0
    assert model.chance is chance
    # of the other tab
    assert model.reality is None


def test_another_seed_draws_others(model: WhatIf) -> None:
    before = model.chance.energy_kwh
    model.desk.day.seed = 5
    assert not np.array_equal(model.chance.energy_kwh, before)


def test_all_runs_are_drawn_until_the_conditions_change(model: WhatIf, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("railjoule.dashboard.pages.what_if.chance.FULL_RUNS", 700)
    assert model.chance.done == 500
    model.draw_all()
    assert model.chance.done == 700
    assert not model.drawing
    model.desk.day.seed = 6
    assert model.chance.done == 500
    model.desk.day.seed = 5


def test_a_robust_plan_is_found_on_request_and_goes_with_its_settings(
    model: WhatIf, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("railjoule.dashboard.pages.what_if.chance.ROBUST_RUNS", 300)
    names = [plot.name for plot in model.figures]
    view = PageHost(model.desk.pages["What if"], Browser(started=True, charts_in_sight=names), Palette(dark=False))
    model.param.update(probability_percent=80.0, candidates=4)
    assert model.robust is None
    model.param.trigger("find_robust")
    found = model.robust.found
    assert not model.searching
    assert len(found.candidates) == 5
    assert found.checked[1].runs == 300
    assert found.checked[1].share_on_time > found.checked[0].share_on_time
    assert model.robust_part.visible
    share = words.share(found.checked[1].share_on_time)
    assert f"the robust plan is on time in {share} %: enough." in model.robust_words.object
    assert view.plots["candidates"].sources["robust"].data["x"] == [100 * found.chosen.drawn.share_on_time]
    assert view.plots["robust_speed"].is_drawn
    # another position error is none of the draws
    model.desk.day.coordinate_error_m = 3.0
    assert model.robust.found is found
    model.probability_percent = 99.0
    assert model.robust is None
    model.param.trigger("find_robust")
    assert model.robust.refusal.startswith("probability = 0.99 is reached by none of 5 plans")
    assert model.failure is None
    assert "is reached by none of 5 plans" in model.robust_words.object
    model.desk.day.seed = 7
    assert not model.robust_part.visible
