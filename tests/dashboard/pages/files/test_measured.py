import numpy as np
import pytest
from measured_example import DRIVERS, FOLDER, driven, recorded

from railjoule.core import solve
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.keep.snapshot import snapshot_of
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.files import texts
from railjoule.dashboard.pages.files.measured import compute_measured, energy_so_far, power_error
from railjoule.dashboard.pages.files.page import Files
from railjoule.dashboard.workbench import Workbench

EXAMPLE = (FOLDER / DRIVERS[0].file).read_bytes()


MEASURED = {}
"""What was computed, by what was asked for: most tests begin with the same example."""


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Files:
    """The page Files with its tab of runs in sight; all work is done in the test's own turn."""

    def computed_once(request):
        key = repr(request)
        MEASURED[key] = MEASURED.get(key) or list(compute_measured(request))
        return iter(MEASURED[key])

    monkeypatch.setattr("railjoule.dashboard.pages.files.runs_tab.compute_measured", computed_once)
    found: Files = Workbench(page="Files").pages["Files"]
    found.tab = "runs"
    PageWorks(found)
    return found


def test_the_shipped_examples_are_what_the_script_writes() -> None:
    for driver in DRIVERS:
        written = (FOLDER / driver.file).read_text().splitlines()
        anew = recorded(driven(driver), driver.seed).splitlines()
        # a solver may end a rounding elsewhere on another machine, and a row has steps
        assert len(written) == len(anew)
        assert sum(a != b for a, b in zip(written, anew, strict=True)) < 0.05 * len(written)


def test_an_example_has_a_saving_that_is_proven_for_the_modelled_train(page: Files) -> None:
    page.try_example()
    measured = page.measured
    assert measured.saving is not None
    run, saving = measured.shown.run, measured.saving
    # the run that the recorder is made of; its power has an error of 1 % a sample
    assert run.measured_kwh == pytest.approx(driven(DRIVERS[0]).energy_kwh, rel=0.01)
    assert saving.optimum.is_proven
    assert saving.optimum.travel_time_s == pytest.approx(run.recording.duration_s)
    assert saving.possible_kwh == pytest.approx(run.modelled.energy_kwh - saving.optimum.energy_kwh)
    shown = str(texts.figures(measured))
    assert f"{100 * saving.possible_kwh / run.modelled.energy_kwh:.1f}<span>%" in shown
    assert "proven for the modelled train" in shown


def test_a_fit_to_the_examples_finds_their_train_and_is_one_step(page: Files) -> None:
    page.try_example()
    measured = page.measured
    found = {parameter.name: parameter for parameter in measured.fit.parameters}
    # the train of tests/measured_example.py: 1.2 N/kN of its 2078.9 kN, 1.8 N/(km/h)2
    for name, true in {
        "resistance.constant_n": 1.2 * 2078.9,
        "resistance.quadratic_n_per_kmh2": 1.8,
        "drive.traction_efficiency": 0.845,
        "auxiliary_power_kw": 2.5,
    }.items():
        assert found[name].low <= true <= found[name].high
    shown = str(texts.fit_block(measured))
    assert "B and C cannot be separated by these runs" in shown
    assert "errors of the gauges leave Auxiliaries open" in shown
    assert "gain of the effort 2 %" in shown
    before, heard = texts.model_error(measured.runs[0]), []
    page.desk.scenario.param.watch(lambda *events: heard.append(events), "edits")
    page.use_fit()
    assert len(heard) == 1
    after = page.measured
    assert before is not None
    error = texts.model_error(after.runs[0])
    assert error is not None
    assert abs(error) < 0.01 < abs(before)
    vehicle = page.desk.scenario.scenario().vehicle
    assert vehicle.drive.traction_efficiency == pytest.approx(found["drive.traction_efficiency"].value)
    assert vehicle.resistance.constant_n_per_kn == 0
    page.desk.scenario.restore()
    assert page.desk.scenario.scenario().vehicle.resistance.constant_n_per_kn == pytest.approx(1.1)


def test_the_optimum_of_a_run_is_that_of_the_scenario_opened_on_drive(page: Files) -> None:
    page.try_example()
    measured = page.measured
    page.open_on("Drive")
    assert page.desk.page == "Drive"
    scenario = page.desk.scenario.scenario()
    assert scenario.title == "Metro, profile II + I, metro-0714.csv"
    assert solve(scenario).energy_kwh == pytest.approx(measured.saving.optimum.energy_kwh, rel=1e-4)


def test_no_saving_is_claimed_where_the_model_errs_by_more(page: Files) -> None:
    page.try_example()
    page.desk.scenario.edit({"drive.traction_efficiency": 0.6})
    measured = page.measured
    assert not measured.saving.is_certain
    assert "kWh off the measured energy" in str(texts.figures(measured))


def test_a_saving_has_an_interval_and_a_part_of_the_line_stands_in_the_heading(page: Files) -> None:
    page.try_example()
    measured = page.measured
    low, high = (100 * end / measured.runs[0].modelled.energy_kwh for end in measured.saving.interval_kwh)
    assert f"{low:.1f} to {high:.1f} % by the error of speed and model" in str(texts.figures(measured))
    assert "laid on" not in texts.subtitle(measured)
    shipped = (FOLDER / "liashenko-ii-108s.csv").read_text().splitlines()
    speeds = "\n".join(",".join(line.split(",")[:2]) for line in shipped)
    page.bring([("part.csv", speeds.encode())])
    measured = page.measured
    assert measured.shown.refusal.endswith("from 0 m and from 1000 m on; say where it begins under Begins at.")
    page.begins_at_m = 1000.0
    measured = page.measured
    assert measured is not None
    assert texts.subtitle(measured).endswith(", laid on 1\u202f000 to 2\u202f300 m of the line\u2019s 2\u202f300 m")
    # 46.0 %, "proven", before: a run of another line, without an energy
    assert "takes more effort than the scenario&#x27;s vehicle has" in str(texts.figures(measured))


def test_a_question_that_is_answered_brings_the_energy(page: Files) -> None:
    text = EXAMPLE.decode().replace("line_power_kw", "power_w")
    page.bring([("mine.csv", text.encode())])
    measured = page.measured
    (doubt,) = measured.shown.doubts
    assert measured.runs[0].measured_kwh is None
    assert power_error(measured.runs[0]) is None
    page.say_of_run(doubt.key, doubt.answers[0][1])
    measured = page.measured
    assert measured.shown.doubts == ()
    assert measured.runs[0].measured_kwh == pytest.approx(driven(DRIVERS[0]).energy_kwh, rel=0.01)
    known = energy_so_far(measured.runs[0])
    assert known[2][-1] == pytest.approx(measured.runs[0].measured_kwh * J_PER_KWH)
    assert np.all(np.diff(known[0]) > 0)


def test_a_file_without_a_speed_says_so_and_a_run_too_long_too(page: Files) -> None:
    page.bring([("none.csv", b"time_s,x\n" + b"".join(b"%d,1\n" % k for k in range(12)))])
    assert page.measured.shown.refusal.startswith("none.csv: no column holds the speed; say which one does.")
    page.say_of_run("meaning x", "speed")
    assert page.measured.shown.refusal
    long = b"time_s,speed_kmh\n" + b"".join(b"%d,%d\n" % (k, min(3 * k, 72, 3 * (599 - k))) for k in range(600))
    page.bring([("long.csv", long)])
    assert "the line of the scenario has 2300 m" in page.measured.shown.refusal
    assert "--" not in page.measured.shown.refusal


def test_files_are_replaced_and_removed(page: Files) -> None:
    page.bring([("one.csv", EXAMPLE)])
    page.bring([("one.csv", EXAMPLE)])
    assert [run.name for run in page.runs] == ["one.csv"]
    page.remove(page.shown_number)
    assert page.files == ()
    assert page.measured is None


def test_a_run_is_compared_with_the_optimum_in_its_time(page: Files) -> None:
    page.try_example()
    run = page.run
    page.compare()
    assert page.desk.page == "Compare"
    assert page.desk.pins[0].trajectory is run.trajectory
    assert page.desk.scenario.scenario().travel_time_s == pytest.approx(run.recording.duration_s)


def test_the_example_is_kept_and_files_are_not(page: Files) -> None:
    page.bring([("one.csv", EXAMPLE)])
    page.try_example()
    kept = page.keep()
    assert kept["example"] is True
    assert "files" not in kept
    assert "one.csv" not in str(snapshot_of(page.desk))
    other = Workbench(page="Files").pages["Files"]
    PageWorks(other)
    other.lay(kept)
    assert [file.name for file in other.runs] == [driver.file for driver in DRIVERS]
    page.example = False
    assert [file.name for file in page.files] == ["one.csv"]


@pytest.mark.parametrize("answers", [{"time_s": 5}, {"speed_kmh": ["x"]}, {"<b>": "speed parsecs"}, {"speed_kmh": ""}])
def test_answers_of_a_hostile_link_do_no_harm(page: Files, answers: dict[str, object]) -> None:
    page.answers = answers
    page.try_example()
    measured = page.measured
    assert measured.shown.run is not None or measured.shown.refusal
