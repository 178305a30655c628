"""The page Motor without a browser: what its charts, numbers and sentences show."""

import pytest
from lines import sent

from railjoule.core import load_scenario
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import energy
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.pages.motor.page import Motor
from railjoule.dashboard.pages.motor.texts import finding, length, run_figures
from railjoule.dashboard.workbench import Workbench


@pytest.fixture(scope="module")
def shown(opened: Workbench) -> Motor:
    """The page with all its figures in sight."""
    names = [plot.name for plot in Motor.figures]
    PageHost(opened.pages["Motor"], Browser(started=True, charts_in_sight=names), Palette(dark=False))
    return opened.pages["Motor"]


@pytest.fixture
def view(shown: Motor, state: Workbench) -> Motor:
    """The same page; what a test changes is put back."""
    return shown


def test_charts_draw_the_run(view: Motor) -> None:
    run = view.run
    charts = view.host.plots
    assert sent(charts["loop_speed"], "planned")[1][-1] == pytest.approx(0.0, abs=1e-6)
    assert max(sent(charts["loop_currents"], "torque current")[1]) == pytest.approx(run.torque_current_a.max())
    # the motors' energy is the sum of its parts
    _, energy = sent(charts["rival_energy"], "EOC")
    eoc = view.rivals.runs["eoc"]
    assert energy[-1] == pytest.approx(sum(eoc.parts_j.values()) / 3.6e6, rel=5e-4)
    assert list(charts["loop_speed"].sources["bands"].data["from"]) == []
    assert charts["loop_speed"].sources["names"].data["text"] == ["planned", "actual"]
    assert 50 < len(view.host.plots["machine_map"].sources["points"].data["x"]) <= 120


def test_the_run_stands_beside_those_it_is_compared_with(view: Motor) -> None:
    table, run = view.compared.object, view.run
    assert [name in table for name in ("by EOC", "by ENOC", "without pre-compensator")] == [True, False, True]
    least = simulate_field_oriented(run.scenario.replace(**{"simulation.flux": "min_loss"}), run.planned).actual
    assert least.energy_kwh < run.actual.energy_kwh
    assert f">{energy(least.energy_kwh)}<" in table
    saved = f"{100 * (1 - least.energy_kwh / run.actual.energy_kwh):.1f} % less"
    assert f"Rotor flux of least loss, a choice of the sidebar, needs {energy(least.energy_kwh)} kWh, {saved}." in (
        view.finding.object
    )


def test_a_limit_that_holds_the_drive_is_told_and_marked(view: Motor) -> None:
    assert view.held.object == ""
    view.max_phase_voltage_v = 400.0
    assert "The voltage limit</span> limited the motors from" in view.held.object
    assert len(view.host.plots["loop_voltage"].sources["bands"].data["from"]) > 0


def test_a_limit_below_the_starting_current_is_refused_above_the_last_run(view: Motor) -> None:
    view.max_current_a = 100.0
    assert view.host.message.visible
    assert "max current = 100 A must be above" in view.host.message.object
    view.max_current_a = 810.0
    assert not view.host.message.visible


def test_the_energy_from_the_supply_is_compared_with_the_plan() -> None:
    """The tram returns no braking energy: its motors' net 1.042 kWh is no number beside the plan's 1.053 kWh."""
    run = simulate_field_oriented(load_scenario("tram-950m").replace(**{"simulation.kind": "field_oriented"}))
    main, *others = run_figures(run)
    # railjoule simulate tram-950m --set 'simulation.kind="field_oriented"': 1.192 kWh driven, +13.2 % energy
    assert "<div class=value>1.192<" in main
    assert "13.2 % above the plan, 1.053 kWh" in main
    assert not any("plan" in other for other in others)
    sentence = "the train needs 1.192 kWh, 13.2 % above the plan\u2019s 1.053 kWh"
    assert sentence in finding(run)


def test_the_cruise_is_drawn_over_the_flux(view: Motor) -> None:
    view.cruise_speed_kmh = 60.0
    sweep = view.flux_sweep
    assert sweep.speed_ms == pytest.approx(60 / 3.6)
    drawn = {name: source.data for name, source in view.host.plots["flux_sweep"].sources.items()}
    current, factor = (drawn["power factor"][axis] for axis in "xy")
    assert current[-1] == pytest.approx(sweep.rated.flux_current_a)
    assert factor[-1] == pytest.approx(100 * sweep.rated.power_factor)
    assert drawn["loss"]["y"][-1] == pytest.approx(100.0)
    assert f"{sweep.min_loss.power_factor:.3f}" in view.fluxes.object
    view.cruise.type("1000")
    assert view.cruise.refusal.startswith("At most ")
    assert view.cruise_speed_kmh == 60.0


def test_a_constant_flux_is_named_beside_a_plan_of_minimum_loss() -> None:
    run = simulate_field_oriented(load_scenario("tram-950m").replace(**{"simulation.kind": "field_oriented"}))
    sentence = "The control keeps the maximum flux that the voltage allows; the plan assumes the flux of minimum loss."
    assert sentence in run.notes


@pytest.mark.parametrize(
    ("metres", "expected"), [(5.5e-5, ("0.06", "mm")), (0.05, ("50.00", "mm")), (7.175, ("7.17", "m"))]
)
def test_small_lengths_are_told_in_millimetres(metres: float, expected: tuple[str, str]) -> None:
    assert length(metres) == expected
