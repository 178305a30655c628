"""Every number of Rawicki that validation shows, held to the bars of the project's fifth issue."""

from typing import NamedTuple

import numpy as np
import pytest
from validated import validated
from validation_rows import beyond

from railjoule.core import load_scenario
from railjoule.core.citation import printed_numbers
from railjoule.core.validation import COMPARISONS, Table, Validation, rawicki_runs


class Tables(NamedTuple):
    """The tables of validation, in their order."""

    figures: Table
    planned: Table
    others: Table
    driven: Table
    replanned: Table
    nameplate: Table
    parameters: Table
    strategy: Table


@pytest.fixture(scope="module")
def validation() -> Validation:
    return validated("rawicki")


@pytest.fixture(scope="module")
def tables(validation: Validation) -> Tables:
    return Tables(*validation.tables)


def printed_rows(*tables, **wanted):
    return [
        row
        for table in tables
        for row in table.rows
        if row.printed and all(getattr(row, name) == value for name, value in wanted.items())
    ]


def test_figures_within_one_and_a_half_percent(tables):
    assert beyond(1.5, printed_rows(tables.figures, tables.strategy, unit="kWh")) == {}


def test_penalties_within_two_points(tables):
    """In points of percent; the printed energies give 114.3 and 58.9 only to a tenth of a point themselves."""
    for row in printed_rows(tables.figures, unit="%"):
        assert abs(row.value - row.printed) < 2, row


def test_every_phase_within_one_and_a_half_percent(tables):
    assert beyond(1.5, printed_rows(tables.driven)) == {}


def test_all_24_numbers_of_phases_are_there(tables):
    assert len(tables.driven.rows) == 24


@pytest.mark.parametrize(
    ("case", "energy_kwh"),
    # findings on Rawicki, column 'own', of a tram identified with other weights
    [
        ("Fig. 1, kr = 0", 1.0516),
        ("Fig. 2, kr = 1", 0.9051),
        ("Fig. 3, kr = 0", 2.2719),
        ("Fig. 4, kr = 1", 1.4288),
    ],
)
def test_figures_are_those_of_the_findings(tables, case, energy_kwh):
    value = next(row.value for row in tables.figures.rows if row.case == case and row.quantity == "En")
    assert value == pytest.approx(energy_kwh, rel=3e-3)


@pytest.mark.parametrize(("case", "energy_kwh"), [("Fig. 3, kr = 0", 1.3766), ("Fig. 4, kr = 1", 0.9268)])
def test_part_two_is_that_of_the_findings(tables, case, energy_kwh):
    value = next(row.value for row in tables.figures.rows if row.case == case and row.quantity == "En of part II")
    assert value == pytest.approx(energy_kwh, rel=3e-3)


def test_free_starting_current_within_three_per_mille(tables):
    """Findings' runs without switching are no optima: railjoule may need less."""
    for row in printed_rows(tables.others):
        least = -0.5 if "without switching" in row.quantity else -0.3
        assert least < row.difference_percent < 0.3, row


@pytest.mark.parametrize(("recuperation", "saving_percent"), [(0, 17.8), (1, 6.6)])
def test_saving_over_constant_speed(tables, recuperation, saving_percent):
    """Findings on Rawicki: the four phases save 17.8 and 6.6 %; the paper's 20 % are over an undefined driver."""
    steady = next(
        row.value
        for row in tables.others.rows
        if "constant speed" in row.quantity and row.case.endswith(f"= {recuperation}")
    )
    assert 100 * (1 - tables.figures.rows[recuperation].value / steady) == pytest.approx(saving_percent, abs=0.2)


def test_nameplate_within_one_percent(tables):
    assert beyond(1, printed_rows(tables.nameplate)) == {}


def test_the_shipped_tram_is_the_identified_one(tables):
    assert beyond(0.02, printed_rows(tables.parameters)) == {}
    assert all("Determined to about" in row.note for row in printed_rows(tables.parameters))


def test_the_tram_is_as_heavy_as_printed():
    vehicle = load_scenario("tram-950m").vehicle
    assert vehicle.total_mass_kg == pytest.approx(22_000)
    assert vehicle.load_mass_kg / vehicle.passenger_mass_kg == pytest.approx(80)


def test_printed_phases_add_up():
    """950 m and 95 s with the stop of 5 s, below Figs. 3 and 4; ways and times are printed to four digits."""
    phases = printed_numbers("rawicki-2013")["phase"]
    for last in ("part II, kr = 0", "part II, kr = 1"):
        ride = [phase for phase in phases if phase["part"] in ("part I", last)]
        assert sum(phase["distance_m"] for phase in ride) == pytest.approx(950, abs=0.15)
        assert sum(phase["duration_s"] for phase in ride) == pytest.approx(90, abs=0.02)


def test_erratum_of_the_nameplate():
    """Efficiency from the other five numbers."""
    plate = printed_numbers("rawicki-2013")["nameplate"]
    taken = 3**0.5 * plate["voltage_v"] * plate["current_a"] * plate["power_factor"]
    assert 1e3 * plate["power_kw"] / taken == pytest.approx(0.910, abs=1e-3)


def test_differences_that_stay_are_explained(tables):
    for table in tables:
        for row in table.rows:
            if row.difference_percent and abs(row.difference_percent) > 0.31:
                assert row.note.endswith("."), (table.title, row)


def test_it_is_registered(validation):
    assert validation.citation.startswith("Rawicki")
    assert len(validation.errata) == 4


def test_bounds_lie_below_the_best_force_laws(tables):
    """Rows of `optimal`, each followed by free switching and by its bound."""
    values = [row.value for row in tables.others.rows if "force laws" in row.quantity or "bound" in row.quantity]
    for without, switched, bound in (values[:3], values[3:]):
        assert bound < switched < without * (1 + 1e-4)


@pytest.fixture
def heavier_tram(monkeypatch, forget_runs):
    """A tare that is 1 % larger."""
    load = rawicki_runs.load_scenario

    def load_heavier(name):
        scenario = load(name)
        return scenario.replace(**{"vehicle.tare_kg": 1.01 * scenario.vehicle.tare_kg})

    monkeypatch.setattr(rawicki_runs, "load_scenario", load_heavier)


@pytest.fixture
def forget_runs():
    def forget():
        for value in vars(rawicki_runs).values():
            if hasattr(value, "cache_clear"):
                value.cache_clear()

    forget()
    yield
    forget()


def test_a_heavier_tram_moves_what_depends_on_its_mass(tables, heavier_tram):
    """Energies of runs and all phases that change the speed move; a cruise, whose resistance has no mass, stays."""
    comparison = COMPARISONS["rawicki"]()
    figures, driven, plate = (comparison.tables[place]() for place in (0, 3, 5))
    for row, ratio in zip(figures.rows, ratios(figures, tables.figures), strict=True):
        # of 22,000 kg 16,500 are tare: 0.75 % more mass, part of whose energy kr = 1 recovers
        assert 1.001 < ratio < 1.012 if row.unit == "kWh" else ratio != 1, row
    for row, ratio in zip(driven.rows, ratios(driven, tables.driven), strict=True):
        assert (ratio == 1) == ("cruise" in row.case), row
    assert set(ratios(plate, tables.nameplate)) == {1.0}


def ratios(table, before):
    return [row.value / other.value for row, other in zip(table.rows, before.rows, strict=True)]


def test_claims_have_the_verdicts_of_their_numbers(validation):
    entries = printed_numbers("rawicki-2013")["claim"]
    found = {entry["name"]: claim for entry, claim in zip(entries, validation.claims, strict=True)}
    assert len(found) == len(entries) >= 12
    verdicts = {name: claim.verdict for name, claim in found.items()}
    # the paper's printed energies: 0.903 and 1.064 kWh; the phases below Figs. 3 and 4 sum to 90 s
    assert [name for name, verdict in verdicts.items() if verdict == "refutes"] == [
        "saving_with_recuperation",
        "time_without_stop",
    ]
    assert [name for name, verdict in verdicts.items() if verdict == "cannot be decided"] == [
        "all_disturbances",
        "rated_efficiency",
    ]
    numbers = {name: claim.found for name, claim in found.items()}
    assert numbers["saving_without_recuperation"].startswith("17.9 %")
    assert numbers["saving_with_recuperation"].startswith("6.6 %")
    assert numbers["longer_cruise"] == "331 m with kr = 1, 169 m with kr = 0"
    assert "9549 W a motor against 10166 W" in found["better_efficiency"].reason


@pytest.mark.parametrize("number", range(4))
def test_figures_pass_through_the_printed_points(number):
    """Speeds at the printed ends of phases of the driver's part, and energies at the end of the ride."""
    over_distance, _, energy = COMPARISONS["rawicki"]().figures[number].compute().panels
    line, printed = energy.lines
    assert (printed.is_printed, line.is_printed) == (True, False)
    assert line.y[-1] == pytest.approx(printed.y[-1], rel=0.015)
    stages = {line.label: line for line in over_distance.lines}
    assert {"start", "constant speed", "coasting", "braking"} <= set(stages)
    if number >= 2:
        # 12.26 m/s at 70.11 m, and the stop after 300 m
        assert stages["printed"].y[1] == 12.26
        assert np.nanmax(stages["start"].y[stages["start"].x < 70.2]) == pytest.approx(12.26, abs=0.01)
        assert stages["stop"].x == pytest.approx([300, 300])
