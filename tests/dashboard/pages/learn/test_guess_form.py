"""The question of a lesson and the bars beside its curve, as the browser is told of them."""

import pytest

from railjoule.dashboard.pages.learn.compute import LessonRequest, LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.guess_form import STEPS, EnergyBars, GuessForm, energies_at
from railjoule.dashboard.pages.learn.guesses import GUESSES


@pytest.fixture(scope="module")
def result() -> LessonResult:
    return compute_lesson(LessonRequest("coasting", 115.0))


def form(taken: list[float | None]) -> GuessForm:
    return GuessForm("coasting", "Why coasting saves", GUESSES["coasting"], 115.0, taken.append)


def test_the_answer_is_told_with_a_guess_alone(result: LessonResult) -> None:
    made = form([])
    made.show(115.0, None, result)
    assert made.verdict == {}
    made.show(115.0, 20.0, None)
    assert (made.verdict, made.guessed) == ({}, True)
    made.show(115.0, 20.0, result)
    assert made.verdict["answer"] == f"{100 * result.saved_share:.1f} %"
    made.show(115.0, None, result)
    assert (made.verdict, made.guessed) == ({}, False)


@pytest.mark.parametrize("message", [{"what": "guess", "value": 41}, {"what": "guess", "value": "20"}, {}, "guess"])
def test_what_is_no_guess_is_not_taken(message: object) -> None:
    taken: list[float | None] = []
    form(taken)._handle_msg(message)
    assert taken == []


def test_the_bars_have_the_energies_of_the_account(result: LessonResult) -> None:
    bars = EnergyBars()
    bars.show(result.runs, "optimum")
    assert [(run["name"], run["kind"]) for run in bars.runs] == [("optimum", "best"), ("constant speed", "other")]
    assert (bars.places[0], bars.places[-1], len(bars.places)) == (0, 1500, STEPS + 1)
    for told, run in zip(bars.runs, result.runs.values(), strict=True):
        # at the end of the way the bars are the account of the whole run, to the four decimals that are sent
        energy = run.energy
        assert told["drawn"][-1] == pytest.approx(energy.traction_j / 3.6e6, abs=1e-4)
        assert told["resistance"][-1] == pytest.approx(energy.running_resistance_j / 3.6e6, abs=1e-4)
        assert told["losses"][-1] == pytest.approx(sum(energy.losses_j.values()) / 3.6e6, abs=1e-4)
        assert told["returned"][-1] == told["motion"][-1] == told["height"][-1] == 0.0
    bars.show({}, "optimum")
    assert (bars.runs, bars.places) == ([], [])


def test_the_account_closes_at_every_place(result: LessonResult) -> None:
    for run in result.runs.values():
        told = energies_at(run, [100.0, 700.0, 1450.0])
        for k in range(3):
            uses = sum(told[name][k] for name in ("motion", "height", "resistance", "losses", "returned"))
            assert uses == pytest.approx(told["drawn"][k], abs=5e-4)
