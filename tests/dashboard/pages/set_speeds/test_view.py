"""The page Set speeds without a browser: what its charts and numbers show."""

import numpy as np
import pytest
from lines import sent

from railjoule.core import load_scenario, solve
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import energy
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.pages.set_speeds.charts import WITH_SET_SPEEDS
from railjoule.dashboard.pages.set_speeds.compute import run_figures
from railjoule.dashboard.pages.set_speeds.page import SetSpeeds
from railjoule.dashboard.pages.set_speeds.texts import rule
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def view(state: Workbench) -> SetSpeeds:
    """The page with all its figures in sight."""
    # the parts of both tabs are made
    state.pages["Set speeds"].tab = "losses"
    names = [plot.name for plot in SetSpeeds.figures]
    PageHost(state.pages["Set speeds"], Browser(started=True, charts_in_sight=names), Palette(dark=False))
    page: SetSpeeds = state.pages["Set speeds"]
    page.tab = "speeds"
    return page


def test_all_charts_draw_the_run(view: SetSpeeds) -> None:
    run = view.run
    assert view.host.plots["limit_speed"].sources["steps"].data["limit"] == pytest.approx(run.limits_kmh)
    assert view.host.plots["limit_speed"].sources["steps"].data["right"] == [1200.0, 2400.0]
    assert len(sent(view.host.plots["limit_speed"], WITH_SET_SPEEDS)[0]) == len(run.run.position_m)
    assert sent(view.host.plots["limit_energy"], WITH_SET_SPEEDS)[1][-1] == pytest.approx(run.run.energy_kwh)
    view.tab = "losses"
    assert len(view.host.plots["motor_map"].sources["points"].data["x"]) == len(run.points.torque_nm)
    # (8)-(12) of the paper: the efficiency of its motors lies between 95 and 97 %
    assert list(view.host.plots["motor_map"].scale.major_label_overrides.values())[-1] in {"95", "96", "97"}
    assert view.host.plots["storage"].sources["chosen"].data["x"] == pytest.approx([run.need.max_drop_kwh])


@pytest.mark.parametrize(
    ("regulator", "does", "other"), [("coast", "coasts above", "brakes"), ("literal", "brakes above", "coasts")]
)
def test_the_rule_is_that_of_the_regulator(regulator: str, does: str, other: str) -> None:
    """The published relay asks for the brake above V + dV, (5) and the words above it."""
    text = rule(load_scenario("kharkiv-like-40kmh").replace(**{"search.regulator": regulator}))
    assert does in text
    assert other not in text


def test_the_cursor_names_lines_as_their_ends_do(view: SetSpeeds) -> None:
    for chart in (view.host.plots[name] for name in ("limit_speed", "limit_effort", "limit_energy")):
        assert [one[0] for one in chart.cursor_data["sources"]] == ["optimal in the same time", WITH_SET_SPEEDS]


def test_one_section_has_one_step_without_a_movable_end(view: SetSpeeds) -> None:
    steps = view.host.plots["limit_speed"].sources["steps"]
    assert steps.data["movable"] == [9, 0]
    view.desk.scenario.choose("liashenko-0")
    view.section_count = 1
    assert view.failure is None
    assert steps.data["movable"] == [0]


def test_a_run_out_of_its_window_is_marked(view: SetSpeeds) -> None:
    assert "permitted 205.3 to" in view.host.figures.object
    view.sections[0].limit_kmh = 70.0
    assert "s too early" in view.host.figures.object
    view.set([20.0, 20.0], [1200.0])
    assert "s too late" in view.host.figures.object


def test_the_sentence_stands_where_the_map_is_missing(view: SetSpeeds) -> None:
    assert view.host.plots["motor_map"].host.visible
    assert view.no_map.object == ""
    view.tab = "losses"
    view.desk.scenario.choose("liashenko-ii")
    assert not view.host.plots["motor_map"].host.visible
    assert "there is no efficiency map" in view.no_map.object


def test_the_losses_by_kind_stand_below_the_map(view: SetSpeeds) -> None:
    losses = view.run.run.energy.losses_j
    for kind in ("copper", "iron", "mechanical", "harmonics", "inverter", "gear"):
        assert f">{energy(losses[kind] / 3.6e6)}<" in view.losses.object
    assert "Brake resistors" not in view.losses.object


def test_the_motor_alone_is_better_than_with_its_inverter(view: SetSpeeds) -> None:
    view.tab = "losses"
    drive = np.array(view.host.plots["motor_map"].sources["map"].data["image"][0])
    view.whose.value = "motor"
    motor = np.array(view.host.plots["motor_map"].sources["map"].data["image"][0])
    both = np.isfinite(drive) & np.isfinite(motor)
    assert np.all(motor[both] >= drive[both])
    assert motor[both].max() > drive[both].max()


def test_inter_station_runs_stand_side_by_side(view: SetSpeeds) -> None:
    """The time of each run by itself is its share of the length, and both ways have the same sections."""
    state, model = view.desk, view
    assert not view.together.visible
    state.scenario.choose("metro-with-limit")
    state.scenario.edit({"line.stations": [{"name": "Middle", "position_m": 750.0}], "timetable.travel_time_s": 200.0})
    assert view.together.visible
    assert model.section_count == 4
    together = model.path
    assert set(model.comparison.runs) == {"together", "separate"}
    assert model.comparison.names == ("from the start to Middle", "from Middle to the end")
    times, energies = run_figures(model.comparison.runs["separate"])
    assert times == pytest.approx(1.01 * 200 * np.array([750, 1550]) / 2300, rel=1e-5)
    assert energies.sum() == pytest.approx(model.comparison.runs["separate"].energy_kwh)
    assert "more than together" in view.runs.object
    model.inter_station_runs = "separate"
    assert len(model.path.search.runs) == 2
    assert model.comparison.runs["separate"] is model.path.run
    assert model.comparison.runs["together"].energy_kwh == pytest.approx(together.run.energy_kwh, rel=1e-6)
    state.scenario.choose("kharkiv-like-40kmh")
    assert view.runs.object == ""


def test_what_a_storage_saves_is_one_sentence(view: SetSpeeds) -> None:
    chosen = view.storage.chosen
    saved = energy(chosen.with_resistors_kwh - chosen.energy_kwh)
    assert f"saves {saved} kWh" in view.storage_text.object
    assert f"The run needs {energy(view.run.need.max_drop_kwh)} kWh" in view.storage_text.object


def test_the_finding_is_the_distance_to_the_optimum_in_the_same_time(view: SetSpeeds) -> None:
    run = view.run.run
    more = f"{100 * (run.energy_kwh / view.run.optimum.energy_kwh - 1):.1f} % more"
    assert f"With 2 set speeds the train needs {energy(run.energy_kwh)} kWh, {more} than" in view.finding.object


def test_numbers_of_sections_stand_beside_each_other(view: SetSpeeds) -> None:
    counts = view.shown_counts
    # the line has sections of its own, without borders the search would take those
    assert list(counts) == [2, 3, 4, 6, 8]
    # those of the page
    assert counts[2].energy_kwh == pytest.approx(view.run.run.energy_kwh)
    best = min(counts, key=lambda count: counts[count].energy_kwh)
    assert f"Of 2 to 8 equal sections, {best} need the least: " in view.finding.object
    for run in counts.values():
        assert f">{energy(run.energy_kwh)}<" in view.by_count.object
    # numbers of other settings do not stay
    view.counts = ((), counts)
    assert view.by_count.object == ""


def test_one_press_uses_the_sections_of_the_other_pages(view: SetSpeeds) -> None:
    assert not view.as_on_drive.visible
    view.desk.scenario.choose("metro-with-limit")
    assert view.as_on_drive.label == "Use 11 sections, as on the other pages"
    view.use_line_sections()
    assert len(view.run.limits_kmh) == 11
    # railjoule solve metro-with-limit --strategy speed_limits
    assert view.run.run.energy_kwh == pytest.approx(solve_set_speeds(view), rel=1e-9)
    assert not view.as_on_drive.visible


def solve_set_speeds(view: SetSpeeds) -> float:
    return solve(view.desk.scenario.scenario().replace(strategy="speed_limits")).energy_kwh
