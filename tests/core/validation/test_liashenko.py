"""Tables, claims and figures of Liashenko 2025: their numbers by direct runs, and the truth of their notes."""

import re
from importlib.resources import files
from operator import attrgetter

import numpy as np
import pytest
from validated import validated

from railjoule.core import load_scenario
from railjoule.core.simulation.following import plan_knowing_load, simulate_following
from railjoule.core.validation import COMPARISONS, first_comparisons, liashenko_runs

number = attrgetter("value")
"""The computed number of a row or claim."""
BY_PLAN, BY_LOAD = "overconsumption", "above a plan for the actual load"
PLACES = ("Table 4", "Table 5", "Table 6", "Table 7")


@pytest.fixture(scope="module")
def validation():
    return validated("liashenko")


@pytest.fixture(params=range(4), ids=PLACES)
def table(validation, request):
    return validation.tables[request.param]


def cells(table, quantity):
    return [row for row in table.rows if row.quantity == quantity and row.unit == "%"]


def verdicts(validation):
    names = [claim["name"] for claim in liashenko_runs.PAPER["claim"]]
    return dict(zip(names, (claim.verdict for claim in validation.claims), strict=True))


def test_all_printed_cells_stand_by_both_measures(table):
    by_plan, by_load = cells(table, BY_PLAN), cells(table, BY_LOAD)
    assert len(by_plan) == len(by_load) == 35
    assert [row.source for row in by_plan] == [row.source for row in by_load]
    assert len({row.source for row in by_plan}) == 35
    # the number that counts is that by the measure of the paper
    assert first_comparisons([table]) == tuple(by_plan)


@pytest.mark.parametrize(("place", "error", "load"), [("Table 5", -20.0, 0.25), ("Table 7", 25.0, 1.0)])
def test_both_measures_are_those_of_direct_runs(validation, place, error, load):
    """(12), written out once more."""
    changes = {"disturbance.coordinate_error_m": error, "disturbance.actual_load_factor": load}
    name = {"Table 5": "liashenko-i", "Table 7": "liashenko-iii"}[place]
    there, back = (load_scenario(name).replace(**changes, **{"line.reverse": reverse}) for reverse in (False, True))
    runs = [simulate_following(one) for one in (there, back)]
    actual = sum(run.actual.energy_kwh for run in runs)
    planned = sum(run.planned.energy_kwh for run in runs)
    known = sum(plan_knowing_load(one, load).energy_kwh for one in (there, back))
    rows = {
        row.quantity: number(row)
        for row in validation.tables[PLACES.index(place)].rows
        if row.case == f"{error:+g} m, load {load:g}"
    }
    assert rows == pytest.approx({BY_PLAN: 100 * (actual / planned - 1), BY_LOAD: 100 * (actual / known - 1)}, abs=1e-6)


def test_light_lines_come_out_in_size(validation):
    """Table 5 at half load: within one point of the print."""
    rows = [row for row in validation.tables[1].rows if row.case.endswith("load 0.5")]
    assert len(rows) == 14
    assert all(abs(number(row) - row.printed) < 1.0 for row in rows)


def test_every_difference_that_stays_has_its_sentence(table):
    assert all(row.note for row in table.rows if row.printed is None or abs(number(row) - row.printed) > 0.05)


def test_the_measure_called_nearer_is_nearer(table):
    spread = {
        quantity: np.sqrt(np.mean([(number(row) - row.printed) ** 2 for row in cells(table, quantity)]))
        for quantity in (BY_PLAN, BY_LOAD)
    }
    *_, first, second = table.rows
    assert {first.quantity: number(first), second.quantity: number(second)} == pytest.approx(spread)
    nearer = "(12)" if spread[BY_PLAN] < spread[BY_LOAD] else "the plan for the actual load"
    assert second.note == f"Nearer in this table: {nearer}."


def test_the_signs_called_printed_are_printed(table):
    note = table.rows[-2].note
    for load in ("0", "1"):
        sentence = re.search(rf"Load {load}, 0 m: .*?Sign as printed: (.+?)\.", note)
        signs = {row.quantity: number(row) * row.printed > 0 for row in table.rows if row.case == f"+0 m, load {load}"}
        assert ("(12)" in sentence[1]) == signs[BY_PLAN]
        assert ("the plan for the actual load" in sentence[1]) == signs[BY_LOAD]


def test_numbers_below_zero_are_explained(validation):
    """By (12) the train is lighter than planned; against a plan for its load it is late, and above one as late."""
    negative = [row for table in validation.tables[:4] for row in cells(table, BY_PLAN) if number(row) < -0.05]
    assert negative
    assert all("lighter" in row.note and row.case.endswith(("load 0", "load 0.25")) for row in negative)
    late = [row for table in validation.tables for row in cells(table, BY_LOAD) if number(row) < -0.05]
    assert late
    for row in late:
        [(delay, least)] = re.findall(r"up to ([\d.]+) s late: .* it lies ([\d.]+)", row.note)
        assert float(delay) > 0
        assert float(least) > 0


def test_figure_4_saves_by_a_lighter_train_that_is_in_time(validation):
    rows = {row.quantity: row for row in validation.tables[4].rows if row.case == "Fig. 4"}
    scenario = load_scenario("liashenko-fig-4")
    less = 1 - plan_knowing_load(scenario, 0.2).energy_kwh / number(rows["planned energy"])
    assert number(rows[BY_PLAN]) == pytest.approx(-12.1, abs=0.1)
    assert f"needs {100 * less:.1f} % less" in rows[BY_PLAN].note
    assert number(rows[BY_LOAD]) > 0 > number(rows["delay"])


def test_examples_of_the_figures_stop_at_their_place(validation):
    errors = [number(row) for row in validation.tables[4].rows if row.quantity == "stopping error"]
    assert errors == pytest.approx([0.0] * 4, abs=0.01)


def test_every_claim_is_examined(validation):
    claims = liashenko_runs.PAPER["claim"]
    assert [claim.claim for claim in validation.claims] == [claim["text"] for claim in claims]
    assert all(claim.found and claim.reason for claim in validation.claims)


def test_verdicts_follow_from_the_tables(validation):
    """The conclusions of the paper, by the rows of its own measure."""
    verdict = verdicts(validation)
    largest = [max(number(row) for row in cells(table, BY_PLAN)) for table in validation.tables[:4]]
    assert (verdict["grows_with_profile"] == "supports") == (sorted(largest) == largest)
    negative = any(number(row) < -0.05 for table in validation.tables for row in cells(table, BY_PLAN))
    assert (verdict["any_error_costs"] == "refutes") == negative
    for name, tables, position_first in (("position_on_easy", (0, 1), True), ("load_on_heavy", (2, 3), False)):
        held = []
        for index in tables:
            rows = {row.case: abs(number(row)) for row in cells(validation.tables[index], BY_PLAN)}
            position = max(value for case, value in rows.items() if case.endswith("load 0.5"))
            load = max(value for case, value in rows.items() if case.startswith("+0 m"))
            held.append((position > load) == position_first)
        assert (verdict[name] == "supports") == all(held)


def test_sensors_move_the_stop_by_their_geometry(validation):
    """D1 and D2 move it by L_st / L_c = 15 / 120 of their deviation, D3 by all of it."""
    claims = dict(zip(verdicts(validation), validation.claims, strict=True))
    assert claims["first_sensors"].found == f"the stop moves by {15 / 120:.3f} m for each metre"
    assert claims["last_sensor"].found == "the stop moves by 1.000 m for each metre"
    assert [claims[name].verdict for name in ("first_sensors", "last_sensor")] == ["supports", "refutes"]


def test_figures_are_rebuilt_with_what_is_printed():
    figures = COMPARISONS["liashenko"]().figures
    assert [figure.place for figure in figures] == [f"Fig. {index}" for index in range(3, 11)]
    scenarios = {entry.name.removesuffix(".toml") for entry in (files("railjoule.assets") / "scenarios").iterdir()}
    printed = iter(liashenko_runs.PAPER["table"])
    for figure in figures:
        assert figure.scenario in scenarios
        data = figure.compute()
        assert data.note
        assert all(len(line.x) == len(line.y) for panel in data.panels for line in panel.lines)
        points = [line.y for line in data.panels[0].lines if line.is_printed]
        if int(figure.place[5:]) > 6:
            table = next(printed)
            assert table["scenario"] == figure.scenario
            assert np.array(points).T.tolist() == table["overconsumption_percent"]
            assert len(data.panels) == 2
            # the page pairs points and lines by their labels
            labels = [line.label for line in data.panels[1].lines]
            assert labels[:5] == labels[5:]
        else:
            assert points == []
            planned, actual = data.panels[0].lines
            assert planned.y[[0, -1]] == pytest.approx([0, 0])
            assert np.ptp(actual.y) > 0


def test_a_train_one_percent_heavier_moves_its_rows(validation, monkeypatch):
    """All rows but those of the plan itself; loads then change its mass by less."""

    def heavier(name):
        scenario = load_scenario(name)
        return scenario.replace(**{"vehicle.tare_kg": 1.01 * scenario.vehicle.tare_kg})

    cached = (liashenko_runs.compared_table, liashenko_runs.example)
    monkeypatch.setattr(liashenko_runs, "load_scenario", heavier)
    try:
        for one in cached:
            one.cache_clear()
        tables = COMPARISONS["liashenko"]().tables
        moved, figures = tables[1](), tables[4]()
    finally:
        for one in cached:
            one.cache_clear()
    for before, after in zip(validation.tables[1].rows, moved.rows, strict=True):
        if before.case == "+0 m, load 0.5":
            assert number(after) == pytest.approx(0, abs=1e-6)
        else:
            # with the planned load, plan and run move alike
            assert abs(number(after) - number(before)) > (1e-6 if before.case.endswith("load 0.5") else 1e-3)
        if before.quantity == BY_PLAN and before.case in {"+0 m, load 0", "+0 m, load 1"}:
            # 1600 kg of 211.9 t
            assert number(after) / number(before) == pytest.approx(1 / 1.00755, rel=2e-3)
    energies = {row.case: number(row) for row in validation.tables[4].rows if row.quantity == "planned energy"}
    for row in figures.rows:
        if row.quantity == "planned energy":
            assert 1.003 < number(row) / energies[row.case] < 1.01
