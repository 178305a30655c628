"""The public API: `import railjoule as rj`, typed construction, own strategies, results as tables and figures."""

import subprocess
import sys
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

import railjoule as rj
from railjoule.core.errors import CheckError, ScenarioError, StrategyRefusedError
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.core.strategy import STRATEGIES, Strategy, register

mpl.use("Agg")
GRADIENTS = pd.DataFrame({"from [m]": [0, 500], "to [m]": [500, 1400], "gradient [permille]": [10, -5]})
LIMITS = pd.DataFrame({"from [m]": [200], "to [m]": [900], "limit [km/h]": [60]})


def own_line(**options):
    return rj.Line.from_tables(gradients=GRADIENTS, **options)


def own_scenario(**options):
    return rj.Scenario(rj.Vehicle.from_preset("metro-81-7036"), own_line(), **{"travel_time_s": 130, **options})


# ---- names


def test_importing_it_loads_no_solver():
    """The command line answers --help without the half second that the solver takes to import."""
    code = "import sys, railjoule; print('numba' in sys.modules, 'pydantic' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "False"]


def test_every_public_name_is_there():
    assert {"solve", "compare", "simulate", "frontier", "sweep", "fit", "Vehicle", "__version__"} <= set(dir(rj))
    for name in set(dir(rj)) - {"__version__"}:
        assert getattr(rj, name) is not None
    with pytest.raises(AttributeError, match="has no attribute 'solv'"):
        rj.solv  # noqa: B018


# ---- typed construction


def test_a_scenario_of_parts_is_that_of_a_file():
    built = own_scenario(title="own")
    assert parse_scenario(format_scenario(built)) == built
    assert built.travel_time_s == 130
    assert [section.gradient_permille for section in built.line.sections] == [10, -5]


def test_a_preset_takes_changes_of_its_keys_and_its_drive():
    train = rj.Vehicle.from_preset("metro-81-7036", load_factor=0.3, drive={"recuperation_factor": 0.4})
    named = rj.load_scenario("liashenko-ii").replace({"vehicle.load_factor": 0.3, "drive.recuperation_factor": 0.4})
    assert train == named.vehicle


def test_tables_give_the_line_that_they_describe(tmp_path):
    LIMITS.to_csv(tmp_path / "limits.csv", index=False)
    stop = rj.Station(position_m=700)
    with pytest.warns(UserWarning, match=r"limits.csv: nothing from .* m, .*: taken as without a limit"):
        line = rj.Line.from_tables(gradients=GRADIENTS, limits=tmp_path / "limits.csv", stations=[stop])
    assert line.length_m == 1400
    assert [station.position_m for station in line.stations] == [700]
    limits = [(section.length_m, section.speed_limit_kmh) for section in line.sections]
    assert limits == [(200, None), (300, 60), (400, 60), (500, None)]


def test_what_a_table_leaves_open_is_a_warning_unless_the_settings_say_it():
    unnamed = GRADIENTS.rename(columns={"gradient [permille]": "gradient"})
    with pytest.warns(UserWarning, match="no unit is named for 'gradient'"):
        assert rj.Line.from_tables(gradients=unnamed).sections[0].gradient_permille == 10
    line = rj.Line.from_tables(gradients=unnamed, settings={"gradients.value_unit": "percent"})
    assert line.sections[0].gradient_permille == pytest.approx(100)


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: rj.Section(length_m=-3), "Section: length_m = -3 must be above 0."),
        (lambda: rj.Line(sections=[{"length_m": -3}]), "Line: sections[0].length_m = -3 must be above 0."),
        (lambda: rj.Vehicle(preset="metro-81-7036"), "Vehicle.from_preset('metro-81-7036') fills them in."),
        (lambda: rj.Vehicle.from_preset("metro"), "there is no preset 'metro' among the vehicles"),
        (lambda: rj.Vehicle.from_preset("metro-81-7036", load_factor=9), "load_factor = 9 must be at most 3."),
        (
            lambda: rj.Vehicle.from_preset("metro-81-7036", rotating_mass_factor=0.1, inertial_mass_kg=3e4),
            "inertial_mass_kg and rotating_mass_factor exclude each other; give one of them.",
        ),
        (lambda: own_scenario(titel="x"), "Scenario: unknown key titel, did you mean 'title'?"),
        (lambda: own_scenario(travel_time_s=None), "Scenario: travel_time_s is missing"),
        (
            lambda: own_scenario(average_speed_kmh=40),
            "needs exactly one of travel_time_s, average_speed_kmh, reserve_percent and reserve_min_per_100km",
        ),
        (
            lambda: own_scenario(timetable=rj.Timetable(travel_time_s=9)),
            "travel_time_s and timetable exclude each other",
        ),
        (lambda: own_scenario(strategy="fast"), "strategy = 'fast' must be 'optimal', 'bellman'"),
        (rj.Line.from_tables, "no table of the line is given"),
        (
            lambda: rj.Line.from_tables(gradients=3),
            "gradients has the type int; it must be the path of a table",
        ),
        (lambda: own_line(settings={"slope.unit": "m"}), "settings: slope.unit must begin with the kind of its table"),
        (lambda: rj.solve(3), "scenario has the type int; it must be a Scenario, the name of a shipped one"),
        (lambda: rj.solve("liashenko-9"), "liashenko-9"),
    ],
)
def test_errors_are_one_sentence(build, sentence):
    with pytest.raises(ScenarioError) as raised:
        build()
    assert sentence in str(raised.value)
    assert "\n" not in str(raised.value)


def test_contradictory_changes_are_refused_and_not_dropped():
    """Of the third review: `with_` given both dropped the first in silence, 117.0 s instead of 130."""
    both = {"timetable.travel_time_s": 130, "timetable.average_speed_kmh": 40}
    with pytest.raises(ScenarioError, match="average_speed_kmh and travel_time_s exclude each other"):
        rj.load_scenario("liashenko-ii").replace(both)


# ---- strategies


def slowed(task):
    return task.fastest_speed_ms * task.shortest_time_s / task.running_time_s


def test_any_function_from_a_task_to_speeds_is_a_strategy():
    run = rj.solve("tram-950m", strategy=slowed)
    assert (run.strategy, run.check.ok, run.travel_time_s) == ("slowed", True, pytest.approx(95.0))
    assert run.energy_kwh > run.lower_bound_kwh


@pytest.mark.parametrize(
    ("function", "error", "sentence"),
    [
        (lambda _: 3, StrategyRefusedError, "returned an array of shape ()"),
        (lambda _: "fast", StrategyRefusedError, "it must return speeds [m/s] as an array"),
        (lambda task: task.fastest_speed_ms + 1, StrategyRefusedError, "returned 1 m/s at 0 m; it must be 0 m/s there"),
        (lambda task: 0 * task.fastest_speed_ms, StrategyRefusedError, "no stop is planned there"),
        (lambda task: np.nan * task.fastest_speed_ms, StrategyRefusedError, "speeds must be finite"),
        (lambda task: 2 * task.fastest_speed_ms, CheckError, "rules"),
    ],
)
def test_what_such_a_function_gets_wrong_is_one_sentence(function, error, sentence):
    with pytest.raises(error) as raised:
        rj.solve("tram-950m", strategy=function)
    assert sentence in str(raised.value)


def test_a_name_is_registered_once_and_the_order_is_kept():
    names = list(STRATEGIES)
    assert names == sorted(names, key=lambda name: STRATEGIES[name].order)
    with pytest.raises(ScenarioError, match="'optimal' is already registered"):
        register(Strategy(name="optimal", run=STRATEGIES["fastest"].run))
    assert Strategy(name="slow_and_steady", run=STRATEGIES["fastest"].run).label == "Slow and steady"


def test_a_comparison_has_a_row_for_each_run_and_a_reason_for_each_refusal():
    found = rj.compare("tram-950m", ["fastest", "eoc"])
    assert found.to_dataframe()["strategy"].tolist() == ["fastest"]
    assert list(found.refused) == ["eoc"]
    with pytest.raises(StrategyRefusedError, match="'fast' is not a strategy"):
        rj.compare("tram-950m", ["fast"])


# ---- results


@pytest.mark.parametrize(("unit", "joules"), [("kWh", 3.6e6), ("Wh", 3600.0), ("MJ", 1e6), ("J", 1.0)])
def test_the_energy_balance_is_a_table_in_any_unit(unit, joules):
    energy = rj.solve("tram-950m-recuperating", "fastest").energy
    table = energy.to_frame(unit)[f"energy_{unit.lower()}"] * joules
    assert table["net"] == pytest.approx(energy.net_j)
    assert table[:3].sum() == pytest.approx(table["net"])
    assert table[4:].sum() == pytest.approx(table["traction"] + table["recuperated"])


def test_an_unknown_unit_is_refused():
    with pytest.raises(ScenarioError, match="unit = 'kwh' must be one of kWh, Wh, MJ, J"):
        rj.solve("tram-950m", "fastest").energy.to_frame("kwh")


@pytest.mark.parametrize(("strategy", "keys"), [("fastest", 1), ("bellman", 2)])
def test_a_run_cites_railjoule_and_its_paper(strategy, keys):
    cited = replace(rj.solve("tram-950m", "fastest"), strategy=strategy).cite()
    assert cited.count("@") == keys
    assert cited.count("{") == cited.count("}")
    assert ("doi = {10.32703/2617-9040-2025-46-1}" in cited) == (keys == 2)
    assert ("Liashenko" in cited) == (keys == 2)


def test_runs_comparisons_and_frontiers_draw_themselves():
    run = rj.solve("liashenko-ii", "fastest")
    speed, limit = run.plot().lines
    assert speed.get_ydata().max() == pytest.approx(run.max_speed_kmh)
    assert np.all(limit.get_ydata() + 1e-6 >= speed.get_ydata()[1:])
    assert len(rj.frontier("liashenko-ii", [130.0, 150.0], "fastest").plot().lines[0].get_xdata()) == 2
    axes = rj.compare("liashenko-ii", ["fastest"]).plot()
    assert [line.get_label() for line in axes.lines] == [f"Fastest, {run.energy_kwh:.3f} kWh"]


def test_a_simulation_takes_the_keys_of_the_disturbance():
    found = rj.simulate("tram-950m", actual_load_factor=0.0, coordinate_error_m=5.0)
    assert {cause.name for cause in found.causes} == {"load", "position"}
    with pytest.raises(ScenarioError, match=r"disturbance\.load"):
        rj.simulate("tram-950m", load=1.0)


def test_several_scenarios_have_their_own_runs_and_measures():
    first = rj.load_scenario("tram-950m")
    second = first.replace({"timetable.travel_time_s": 110.0, "vehicle.load_factor": 1.0})
    found = rj.compare([first, second])
    solved = [rj.solve(first), rj.solve(second)]
    table = found.to_dataframe()
    assert table["energy_kwh"].tolist() == [run.energy_kwh for run in solved]
    assert table["lower_bound_kwh"].tolist() == [run.lower_bound_kwh for run in solved]
    for (_, row), run in zip(table.iterrows(), solved, strict=True):
        # from the arrays and the account of the run, in units of their own
        assert row["energy_per_tonne_km_wh"] == pytest.approx(
            run.energy.net_j / 3600 / (run.scenario.vehicle.total_mass_kg / 1000) / (run.position_m[-1] / 1000)
        )
        assert row["energy_per_km_kwh"] == pytest.approx(run.energy.net_j / 3.6e6 / 0.95)
        assert row["mean_speed_kmh"] == pytest.approx(3.6 * 950 / run.time_s[-1])
        assert row["max_supply_power_kw"] == pytest.approx(max(run.supply_power_w) / 1000)
    assert found.shortest_times_s[0] < found.shortest_times_s[1] < 110.0
    pair = rj.compare(["tram-950m", "tram-950m"], ["fastest", "optimal"])
    assert [run.strategy for run in pair.runs] == ["fastest", "optimal"] * 2


@pytest.mark.parametrize(("scenarios", "sentence"), [([], "the list is empty"), (7, "has the type int"), ([7], "has")])
def test_what_is_no_scenario_cannot_be_compared(scenarios, sentence):
    with pytest.raises(ScenarioError, match=sentence):
        rj.compare(scenarios)
