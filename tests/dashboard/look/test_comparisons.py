from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import Bound, Trajectory, load_scenario, solve
from railjoule.core.lower_bound import Reference
from railjoule.dashboard.look import comparisons
from railjoule.dashboard.look.words import MINUS


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return solve(load_scenario("liashenko-ii"))


@pytest.mark.parametrize(
    ("energy", "reference", "text", "sentence"),
    [
        (5.29, 5.0, "+5.8 %", "5.8 % above"),
        (4.38, 5.0, f"{MINUS}12.4 %", "12.4 % below"),
        (5.0, 5.0, "0.00 %", "0.00 % above"),
        (27.457, -0.628, "+28.09 kWh", "28.09 kWh above"),
        (-2.0, -1.0, f"{MINUS}1.000 kWh", "1.000 kWh below"),
    ],
)
def test_an_energy_lies_above_another(energy: float, reference: float, text: str, sentence: str) -> None:
    amount = comparisons.above(energy, reference)
    assert str(amount) == text
    assert amount.sentence == sentence


def test_a_column_of_percentages_tells_another_unit() -> None:
    assert comparisons.above(5.29, 5.0).cell == "+5.8"
    assert comparisons.above(27.457, -0.628).cell == "+28.09 kWh"
    assert comparisons.cell(None) == "\u2013"


@pytest.mark.parametrize(
    ("gap", "text"),
    [(5e-7, "+0.01 %"), (-5e-7, "0.00 %"), (2e-5, "+0.01 %"), (0.0005, "+0.05 %"), (-4e-5, "0.00 %")],
)
def test_a_gap_does_not_read_as_none(gap: float, text: str) -> None:
    assert str(comparisons.above_bound(4.0 * (1 + gap), 4.0, gap)) == text


def test_without_a_bound_there_is_no_gap(run: Trajectory) -> None:
    assert comparisons.above_own_bound(replace(run, bound=None)) is None
    assert comparisons.above_reference(replace(run, reference=None)) is None


def test_a_saving_is_never_negative() -> None:
    """A computer that spends 12.4 % more than the driver costs that."""
    assert comparisons.saving(1.124, 1.0) == ("costs", ("12.4", "%"))
    assert comparisons.saving(0.9, 1.0) == ("saves", ("10.0", "%"))
    assert comparisons.saving(1.0, 1.0) == ("saves", ("0.00", "%"))
    assert comparisons.saving(1.0, -1.0) == ("costs", ("2.000", "kWh"))


def test_only_a_proven_reference_is_the_optimum(run: Trajectory) -> None:
    assert comparisons.is_reference(run)
    own = run.reference
    assert comparisons.reference_words(own, own.within_s) == "optimum of 2.223 kWh"
    other = Reference(own.energy_j, "bellman", own.within_s + 1, proven=False)
    assert comparisons.reference_words(other, own.within_s) == "best known run (Bellman) of 2.223 kWh in 134.7 s"
    assert not comparisons.is_reference(replace(run, reference=other))


@pytest.mark.parametrize(
    ("strategy", "time", "words"),
    [
        ("optimal", 9999.04, ""),
        ("optimal", 5769.6, "4\u202f229.4 s earlier than the timetable\u2019s 9\u202f999.0 s: more time saves nothing"),
        ("fastest", 9990.0, "9.0 s earlier than the timetable\u2019s 9\u202f999.0 s"),
        ("speed_limits", 10_003.0, "4.0 s later than the timetable\u2019s 9\u202f999.0 s"),
    ],
)
def test_another_time_than_asked_is_told(strategy: str, time: float, words: str) -> None:
    assert comparisons.other_time(strategy, time, 9999.0) == words


def retimed(run: Trajectory, later_s: float, asked_later_s: float = 0.0) -> Trajectory:
    """Return a run that takes more time than it does, and was asked for in more."""
    more = later_s - float(run.time_s[-1] - run.scenario.travel_time_s)
    timetable = run.scenario.timetable.model_copy(update={"travel_time_s": run.scenario.travel_time_s + asked_later_s})
    scenario = run.scenario.model_copy(update={"timetable": timetable})
    return replace(run, scenario=scenario, time_s=np.append(run.time_s[:-1], run.time_s[-1] + more))


def test_a_late_run_tells_how_late_it_is_instead_of_a_percentage(run: Trajectory) -> None:
    in_time, late = retimed(run, 0.04), retimed(run, 1.7)
    assert comparisons.in_time_asked(in_time) == "0.00"
    assert comparisons.in_time_asked(late) == "1.7 s late"
    # beside another run too, unless that one takes as long
    assert comparisons.beside(late, in_time) == "1.7 s late"
    assert comparisons.beside(late, retimed(run, 1.7)) == "0.00"
    assert comparisons.beside(in_time, late) == "0.00"
    # less time needs more energy, which is no loss by the way of driving
    early = replace(retimed(run, -36.4), strategy="fastest")
    assert comparisons.in_time_asked(early) == "36.4 s early"
    assert comparisons.beside(early, run) == "36.4 s early"
    # a best known run that gains nothing by waiting has its own percentage
    assert comparisons.in_time_asked(retimed(run, -36.4)) == "0.00"
    # later than another one is none where the timetable asks for it
    assert comparisons.beside(retimed(run, 10.0, asked_later_s=10.0), in_time) == "0.00"


@pytest.mark.parametrize(
    ("energy", "delay_s", "stop_error_m", "more", "cell", "outcome"),
    [
        # in time at the stop: less is a saving
        (9.0, 0.04, -0.04, f"{MINUS}10.0 %", f"{MINUS}10.0", f"{MINUS}10.0 % energy, 0.0 s, stopping error"),
        (11.0, 3.2, 14.5, "+10.0 %", "+10.0", "+10.0 % energy, +3.2 s, stopping error +14.50 m."),
        (9.0, 3.2, 14.5, f"{MINUS}1.000 kWh", "late", "3.2 s late, 14.5 m beyond the stop; "),
        (9.0, -3.2, -2.0, f"{MINUS}1.000 kWh", "short", "2.0 m short of the stop; "),
        (9.0, 0.0, 2.0, f"{MINUS}1.000 kWh", "beyond", f"2.0 m beyond the stop; {MINUS}1.000 kWh energy."),
    ],
)
def test_what_misses_timetable_or_stop_saves_nothing(
    energy: float, delay_s: float, stop_error_m: float, more: str, cell: str, outcome: str
) -> None:
    run = energy, 10.0, delay_s, stop_error_m
    assert str(comparisons.extra(*run)) == more
    assert comparisons.extra_cell(*run) == cell
    assert outcome in comparisons.outcome(*run)


def test_one_arrives_later_or_earlier() -> None:
    assert comparisons.arrival(1.1) == "1.1 s later"
    assert comparisons.arrival(-1.1) == "1.1 s earlier"
    assert comparisons.arrival(0.01) == "at the same time"


def test_printed_percentages_differ_by_points() -> None:
    assert comparisons.printed_difference(2129.0, 2.129) == "+2.1 pp"
    assert comparisons.printed_difference(-0.5, None) == f"{MINUS}0.50 %"
    assert comparisons.printed_difference(None, None) == ""


def test_a_bound_without_end_tells_nothing(run: Trajectory) -> None:
    endless = Bound(float("-inf"), "None.", run.travel_time_s, float("-inf"))
    assert str(comparisons.above_own_bound(replace(run, bound=endless))) == "\u2013 kWh"
