import numpy as np
import pytest
from recordings import COLUMNS, as_csv, samples, true_runs

from railjoule.core import load_scenario
from railjoule.core.errors import RecordingError
from railjoule.core.identification import fit_runs, hold_out, monte_carlo_scenario
from railjoule.core.identification.fit import resistance_deviation
from railjoule.core.identification.parameters import EFFICIENCY, MASS_FACTOR, RESISTANCE, Model
from railjoule.core.identification.problem import simulated_speed
from railjoule.core.measured import measured_run, read_recording
from railjoule.core.studies.montecarlo import draw

TIMES_S = (83.0, 89.0, 108.0, 96.0)


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("liashenko-ii")


@pytest.fixture(scope="module")
def truths():
    return true_runs(TIMES_S)


@pytest.fixture(scope="module")
def truth(truths):
    return Model(truths[0].scenario.vehicle, RESISTANCE, 20.0).first


def recorded(truths, scenario, seed=0, names=COLUMNS):
    texts = [as_csv(samples(run, 100 * seed + number), names) for number, run in enumerate(truths)]
    return [measured_run(read_recording(text, f"run-{number}"), scenario) for number, text in enumerate(texts)]


@pytest.fixture(scope="module")
def runs(truths, scenario):
    return recorded(truths, scenario)


@pytest.fixture(scope="module")
def fit(runs, scenario):
    return fit_runs(runs[:3], scenario)


def test_finds_the_train_that_was_recorded(fit, truth):
    for parameter in fit.parameters:
        assert parameter.low <= truth[parameter.name] <= parameter.high
    values = fit.values
    assert values[MASS_FACTOR] == pytest.approx(truth[MASS_FACTOR], abs=0.01)
    assert values[EFFICIENCY] == pytest.approx(truth[EFFICIENCY], abs=0.008)
    # one by one A, B and C are hardly known; their sum at the speeds of the runs is
    assert resistance_deviation(fit) < 0.05


def test_intervals_hold_the_truth_as_often_as_they_say(truths, truth, scenario):
    # Of 10 intervals of 95 %, fewer than 7 contain it once in 1,000.
    held = dict.fromkeys((*RESISTANCE, MASS_FACTOR), 0)
    for seed in range(10):
        for parameter in fit_runs(recorded(truths[:3], scenario, seed), scenario).parameters[: len(held)]:
            held[parameter.name] += parameter.low <= truth[parameter.name] <= parameter.high
    assert min(held.values()) >= 7, held


def test_a_held_out_run_is_predicted_within_a_per_cent(runs, scenario):
    held = hold_out(runs, scenario)
    assert [one.name for one in held] == [run.recording.name for run in runs]
    assert max(abs(one.energy_error) for one in held) < 0.01
    assert hold_out(runs[:1], scenario) == ()


def test_a_single_speed_tells_no_term_of_the_resistance_from_the_others(scenario, truths):
    # a train that holds one speed, with the effort that the true one needs for it
    line = scenario.replace(**{"line.preset": "flat-5km"})
    constant, linear, quadratic = (
        Model(truths[0].scenario.vehicle, RESISTANCE, 20.0).first[name] for name in RESISTANCE
    )
    effort = (constant + linear * 54.0 + quadratic * 54.0**2) / 1e3
    random = np.random.default_rng(1)
    rows = [f"{second},54,{effort * (1 + 0.01 * random.standard_normal()):.5f}" for second in range(80)]
    text = "\n".join(["time_s,speed_kmh,effort_kn", *rows])
    found = fit_runs([measured_run(read_recording(text, "hold.csv"), line, 10.0)], line, RESISTANCE)
    assert set(found.undetermined) == set(RESISTANCE)
    assert set(found.confounded[0]) == set(RESISTANCE)
    assert "cannot be separated by these runs: coasting from high to low speed would" in found.sentences[0]
    # what they add up to at that speed is known all the same
    assert resistance_deviation(found) < 0.05


def test_coasting_on_the_level_tells_resistance_over_inertia_alone(truths, truth):
    line = load_scenario("liashenko-ii").replace(**{"line.preset": "flat-5km"})
    vehicle = truths[0].scenario.vehicle
    a, b, c = (truth[name] * 3.6**power for power, name in enumerate(RESISTANCE))
    begins = np.zeros(80, dtype=bool)
    begins[0] = True
    still = (np.ones(80), np.full(80, 20.0), begins, np.zeros(80), np.ones(80))
    speed = np.append(20.0, simulated_speed(*still, a, b, c, vehicle.total_inertia_kg))
    text = "\n".join(["time_s,speed_ms,effort_kn", *(f"{s},{np.round(v, 1)},0" for s, v in enumerate(speed[:60]))])
    run = measured_run(read_recording(text, "coast.csv"), line, 5.0)
    found = fit_runs([run], line, (*RESISTANCE, MASS_FACTOR), coasting_only=True)
    assert MASS_FACTOR in found.undetermined
    assert any(MASS_FACTOR in group and RESISTANCE[0] in group for group in found.confounded)


def test_power_alone_does_not_tell_efficiency_from_inertia_and_resistance():
    # The trap of fits to energies: on one gradient, twice the efficiency is as good as half of all resistance and mass.
    # Where efforts are measured beside the power, both are known.
    scenario = load_scenario("liashenko-0")
    truths = true_runs((75.0, 85.0, 95.0), "liashenko-0")
    columns = [samples(run, number) for number, run in enumerate(truths)]
    for one in columns:
        one["brake"] = (one["effort_kn"] < 0).astype(float)
    names = ("time_s", "speed_ms", "power_kw", "brake")
    flat = [measured_run(read_recording(as_csv(one, names), "run.csv"), scenario) for one in columns[:3]]
    found = fit_runs(flat, scenario, (*RESISTANCE, MASS_FACTOR, EFFICIENCY))
    by_effort = fit_runs(recorded(truths[:3], scenario), scenario, (*RESISTANCE, MASS_FACTOR, EFFICIENCY))
    width = {one.name: one.high - one.low for one in found.parameters}
    assert width[EFFICIENCY] > 2 * {one.name: one.high - one.low for one in by_effort.parameters}[EFFICIENCY]
    assert {EFFICIENCY, MASS_FACTOR} <= set(found.undetermined)
    assert any({EFFICIENCY, MASS_FACTOR} <= set(group) for group in found.confounded)
    assert EFFICIENCY not in by_effort.undetermined


def test_the_speed_alone_is_refused(scenario, truths):
    (run,) = recorded(truths[:1], scenario, names=("time_s", "speed_ms"))
    with pytest.raises(RecordingError, match="a fit needs a column of the effort, or of power and of the brake"):
        fit_runs([run], scenario)


@pytest.mark.parametrize(
    ("free", "words"),
    [(("colour",), "--free colour: must be among"), (("auxiliary_power_kw",), "the runs have no column of power")],
)
def test_refuses_parameters_that_cannot_be_free(scenario, truths, free, words):
    (run,) = recorded(truths[:1], scenario, names=("time_s", "speed_ms", "effort_kn"))
    with pytest.raises(RecordingError, match=words):
        fit_runs([run], scenario, free)


def test_the_fit_feeds_monte_carlo(fit, scenario):
    prepared = monte_carlo_scenario(fit, scenario)
    resistance = draw(prepared.replace(**{"montecarlo.runs": 2000}))["resistance_factor"]
    assert np.std(np.log(resistance)) == pytest.approx(resistance_deviation(fit), rel=0.1)
    assert prepared.vehicle.resistance.constant_n == pytest.approx(fit.values[RESISTANCE[0]])
