from dataclasses import asdict

import pytest

from railjoule.core.advice import Instruction
from railjoule.dashboard.command import terminal
from railjoule.dashboard.command.terminal import (
    bound_words,
    driver_words,
    table_lines,
    verdict,
)
from railjoule.dashboard.command.values import printable


@pytest.mark.parametrize(
    ("gap", "words"),
    [
        (None, "no bound known"),
        (9e-7, "proven optimal, 0.01 % above the bound"),
        (-1e-9, "proven optimal, 0.00 % above the bound"),
        (3e-4, "proven optimal, 0.03 % above the bound"),
        (7e-4, "0.07 % above the bound"),
        (0.0166, "1.7 % above the bound"),
        (2.5, "250 % above the bound"),
    ],
)
def test_gaps_in_words(gap, words):
    bound = None if gap is None else 4.0
    energy_kwh, proven = 4.0 * (1 + (gap or 0.0)), words.startswith("proven optimal")
    assert bound_words({"energy_kwh": energy_kwh, "lower_bound_kwh": bound, "gap": gap, "proven": proven}) == words


def run(energy_kwh, of_kwh=4.0, strategy="phases", proven=True, within_s=95.0):
    """Return what `verdict` reads of a run beside the optimum."""
    known = {"strategy": "optimal", "energy_kwh": of_kwh, "within_s": within_s, "proven": proven}
    values = {"energy_kwh": energy_kwh, "strategy": strategy, "allowed_time_s": 95.0, "reference": known}
    values["travel_time_s"] = within_s
    return {**values, "lower_bound_kwh": 4.0, "gap": energy_kwh / 4.0 - 1, "proven": energy_kwh == 4.0}


@pytest.mark.parametrize(
    ("summary", "words"),
    [
        (run(4.4), "10.0 % above the optimum of 4.000 kWh"),
        (run(3.9, proven=False), "2.5 % below the best known run of 4.000 kWh"),
        (run(4.4, proven=False, within_s=99.9), "4.9 s late, 10.0 % above the best known run of 4.000 kWh in 99.9 s"),
        (run(27.5, -0.628), "28.13 kWh above the optimum of -0.628 kWh"),
        (run(4.0, strategy="optimal"), "proven optimal, 0.00 % above the bound"),
        ({**run(4.4), "reference": None}, "10.0 % above the bound"),
    ],
)
def test_a_run_is_measured_against_the_best_known_one(summary, words):
    assert verdict(summary) == words


def test_advice_in_words():
    advice = [
        Instruction("full_power", 0, 57.2),
        Instruction("coast", 342),
        Instruction("brake", 1180, 0, 1300, fully=True),
        Instruction("stand", 1300, stand_s=21.0),
    ]
    assert driver_words([asdict(told) for told in advice]) == (
        "full power to 57.2 km/h, coast from 342 m, brake fully from 1,180 m to a stop at 1,300 m, "
        "stand 21 s at 1,300 m"
    )


def test_a_table_has_its_numbers_to_the_right():
    assert table_lines(("name", "kWh"), [("a", "1.0"), ("longer", "10.0")]) == [
        "name     kWh",
        "------  ----",
        "a        1.0",
        "longer  10.0",
    ]


def test_a_comparison_without_results_tells_why():
    refused = [{"strategy": "optimal", "reason": "the optimum was not found within 100 iterations."}]
    text = terminal.comparison_text({"results": [], "refused": refused})
    assert text == "Optimal: the optimum was not found within 100 iterations."


def test_titles_cannot_steer_the_terminal():
    assert printable("Night\x1b[31m run\n\u202e") == "Night [31m run  "


def test_lines_are_no_wider_than_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    lines = terminal.validation_text({"citation": "word " * 60, "tables": [], "claims": [], "errata": []}).splitlines()
    assert len(lines) > 3
    assert max(map(len, lines)) <= 70
