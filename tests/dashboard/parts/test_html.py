import re
from dataclasses import replace

import pytest
from every_drive import DRIVES, train
from markup import plain
from needing import needing

from railjoule.core import load_scenario, solve
from railjoule.core.best_known import with_best_known
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.pins import Pin
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs

HOSTILE = '<img src=x onerror="alert(1)">'


@pytest.fixture(scope="module")
def runs() -> Runs:
    return compute_runs(RunsRequest(load_scenario("ftorek-300s"), ("eoc", "enoc", "fastest")))


def beside_phases(name: str) -> list[str]:
    """Return the figures of the proof for the optimum of a scenario and for its four phases."""
    runs = compute_runs(RunsRequest(load_scenario(name), ("phases",))).runs
    return [plain(parts.proof_figure(runs[strategy])) for strategy in ("optimal", "phases")]


def pinned(runs: Runs, name: str) -> Pin:
    """Return the pinned fastest run under a name."""
    return Pin(name, runs.runs["fastest"], "pin_1", Recipe("ftorek-300s", None, {}, "fastest"))


@pytest.mark.parametrize(
    "markup",
    [
        parts.heading("Drive", HOSTILE, HOSTILE, HOSTILE),
        parts.failure(HOSTILE, HOSTILE, HOSTILE),
        parts.refusal(f"{HOSTILE}: {HOSTILE}"),
        parts.figure(*[HOSTILE] * 7),
        parts.figures([HOSTILE]),
        parts.table(HOSTILE, [HOSTILE], [([HOSTILE], True)]),
        parts.table("", [HOSTILE], [([HOSTILE], True)]),
        parts.note_paragraphs([HOSTILE]),
        parts.flow_bar(HOSTILE, HOSTILE, 0.0, 1.0, HOSTILE, strong=True),
    ],
)
def test_texts_of_users_are_escaped(markup: str) -> None:
    assert "<img" not in markup
    assert "&lt;img" in markup


def test_pieces_of_html_in_a_table_stay_html() -> None:
    piece = Markup("<b>5</b>")
    assert parts.plain_table([piece, "<"], [([piece, "<"], True)]) == (
        "<table><thead><tr><th scope=col><b>5</b><th scope=col>&lt;<tbody><tr class=chosen><td><b>5</b><td>&lt;</table>"
    )


def test_pieces_of_html_stay_html_and_are_sent_as_they_are() -> None:
    detail = parts.markup("<b>{}</b> {}", "1 < 2", parts.PROVEN)
    assert str(detail) in str(parts.figure("Energy", "1", "kWh", detail))
    assert detail.endswith("<b>1 &lt; 2</b> <span class=proven>\u2713 proven</span>")
    pane, text = parts.html_pane(detail), parts.html_pane(str(detail))
    assert pane._transform_object(pane.object) == text._transform_object(text.object)


def test_figures_of_the_optimum(runs: Runs) -> None:
    text = plain(parts.run_figures(runs, runs.runs["optimal"], None, stale=False))
    assert "Energy from the supply 4.181 kWh for 300.0 s" in text
    assert "Above the bound +0.02 % \u2713 proven" in text


def test_an_optimum_that_is_not_proven_is_told_by_its_bound() -> None:
    best, phases = beside_phases("tram-950m-recuperating")
    # the bound for every driving, which chains of boxes have yet to raise
    assert best == "Above the bound +0.12 % \u25d0 bound 0.827 kWh"
    assert phases == "Above best known +9.5 % bound 0.827 kWh"


def test_an_optimum_with_idle_losses_may_be_proven_by_its_first_bound() -> None:
    best, phases = beside_phases("tram-950m")
    assert best == "Above the bound +0.05 % \u2713 proven"
    assert phases == "Above the optimum +5.8 % optimum 0.995 kWh"


def test_a_better_run_than_the_unproven_optimum_is_the_best_known() -> None:
    found = compute_runs(RunsRequest(load_scenario("kharkiv-like-40kmh"), ("bellman",))).runs
    cheap = needing(found["bellman"], 0.999 * found["optimal"].energy.net_j)
    optimal, bellman = (plain(parts.proof_figure(run)) for run in with_best_known([found["optimal"], cheap]))
    # 1 / 0.999, and the bound for every driving
    assert "Above best known +0.10 % bound 8.05 kWh" in optimal
    assert bellman == "Above the bound +2.5 % \u25d0 bound 8.05 kWh"


def test_a_run_without_bound_says_so(runs: Runs) -> None:
    text = plain(parts.proof_figure(replace(runs.runs["optimal"], bound=None, reference=None)))
    assert text == "Above the bound \u2013 no bound is known"


@pytest.mark.parametrize("drive", DRIVES)
def test_every_loss_of_every_drive_has_words(drive: str) -> None:
    assert set(solve(train(drive), "fastest").energy.losses_j) <= set(words.LOSS_WORDS)


def test_the_table_of_runs_compares_with_the_pinned_one(runs: Runs) -> None:
    markup = parts.runs_table(runs, "optimal", [pinned(runs, HOSTILE), pinned(runs, "my fastest")])
    assert "<img" not in markup
    text = plain(markup)
    assert "to pinned, %" in text
    assert "Pinned: my fastest" in text


@pytest.mark.parametrize(
    ("now", "before", "text"),
    [
        (9.0, 10.0, "\u25bc 10.0 % against pinned 10.00"),
        (11.0, 10.0, "\u25b2 10.0 % against pinned 10.00"),
        (10.0, 10.0, "as pinned, 10.00"),
        (10.0, -1.0, "\u25b2 11.00 kWh against pinned \u22121.000"),
    ],
)
def test_changes_against_the_pinned_run(now: float, before: float, text: str) -> None:
    assert plain(parts.change(now, before)) == text


def test_advice_on_a_continuous_curve_has_few_lines_and_long_advice_is_scrolled(runs: Runs) -> None:
    run = runs.runs["optimal"]
    assert len(run.advice) == 17
    assert parts.advice(run, stale=False).count("<li><b>") == 4
    assert "many" not in parts.advice(run, stale=False)
    legs = parts.advice(solve(load_scenario("metro-10-stations")), stale=False)
    assert "<ol class='many legs' tabindex=0 aria-label='All instructions'>" in legs


def test_advice_of_a_line_with_stations_is_by_legs() -> None:
    markup = parts.advice(solve(load_scenario("metro-10-stations")), stale=False)
    ways = re.findall("<span class=way>([^<]*)</span>", markup)
    assert (ways[0], ways[-1]) == ("Harbour \u2013 Old Town", "Mills \u2013 Hill")
    assert len(ways) == 9
    legs = markup.split("<li class=leg>")[1:]
    assert [leg.count("<li><b>") for leg in legs] == [4, 4, 4, 4, 4, 4, 4, 6, 3]
    assert all("stand" in plain(leg) for leg in legs[:-1])


def test_stops_without_a_name_are_places(runs: Runs) -> None:
    stations = [{"position_m": 1000.0, "dwell_s": 20.0}, {"position_m": 2000.0, "name": HOSTILE}]
    run = solve(load_scenario("ftorek-300s", {"line.stations": stations, "timetable.travel_time_s": 500.0}))
    markup = parts.advice(run, stale=False)
    text = plain(markup)
    assert "0 m \u2013 1 000 m" in text
    assert "1 000 m \u2013 <img" in text
    assert "<img" not in markup


def test_the_table_of_phases_tells_what_the_advice_does() -> None:
    run = solve(load_scenario("metro-with-limit", {"vehicle.auxiliary_power_kw": 50.0}))
    markup = parts.phase_table(run)
    rows = [plain(row.replace("<td>", " | ")).removeprefix("| ") for row in markup.split("<tr>")[2:]]
    assert len(rows) == len(run.advice) + 1
    brake = next(row for row in rows if row.startswith("3 brake"))
    told = run.advice[2]
    assert brake.startswith(f"3 brake | {told.from_m:.0f} | ")
    assert f"| {words.tenths(told.to_kmh or 0)} |" in brake
    assert next(row for row in rows if "coast" in row).endswith("| 0.000")
    # 50 kW for 170 s
    assert rows[-1] == "Auxiliaries | | | | 2.361"


def test_tables_have_names_under_which_they_are_saved() -> None:
    markup = parts.table(parts.markup("Runs <b>here</b>"), ("Run",), [(("one",), False)])
    assert parts.plain_table(("Run",), [(("one",), False)], "Runs here") in markup
    assert "<table data-name='Runs here'>" in markup


def test_the_price_of_a_second_is_that_of_the_run_where_its_strategy_tells_one(runs: Runs) -> None:
    optimum, enoc = runs.runs["optimal"], runs.runs["enoc"]
    dearer = replace(enoc, price_of_time_w=2 * optimum.price_of_time_w)
    told = parts.price_figure(enoc, optimum)
    assert f"{words.price(optimum.price_of_time_w)} Wh/s 1 s more: \u22120.30 %" in plain(told)
    assert "title='Value of the optimum'" in told
    told = parts.price_figure(dearer, optimum)
    assert f"{words.price(2 * optimum.price_of_time_w)} Wh/s 1 s more: \u22120.59 %" in plain(told)
    assert "title" not in told
