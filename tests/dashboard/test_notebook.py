"""Runs in notebooks: what HoloViews holds of them, and the figures that Bokeh makes of that."""

import json

import holoviews as hv
import numpy as np
import pytest
from bokeh.models import HoverTool, Span
from bokeh.plotting import figure
from builders import plain_scenario
from example_notebook import PATH, executed

from railjoule.core import Trajectory, solve
from railjoule.dashboard.charts.quantities import ENERGY, SPEED
from railjoule.dashboard.look.tokens import DASHES, PIN_DASHES, THEMES
from railjoule.dashboard.notebook import compare, to_holoviews


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return solve(plain_scenario(), "optimal")


@pytest.fixture(scope="module")
def fastest() -> Trajectory:
    return solve(plain_scenario(), "fastest")


def drawn(shown: hv.Layout | hv.Overlay) -> list[figure]:
    """Return the figures that a notebook shows, from above."""
    found = hv.render(shown, backend="bokeh")
    return [found] if isinstance(found, figure) else [f for f, _, _ in found.children]


def test_values_are_those_of_the_run_in_the_units_of_its_caption(run: Trajectory) -> None:
    speed, energy, effort = to_holoviews(run)
    assert [str(curve.vdims[0].label) for curve in (speed, energy)] == [
        "Speed, km/h",
        "Energy from the supply so far, kWh",
    ]
    np.testing.assert_array_equal(speed.dimension_values("position"), run.position_m)
    np.testing.assert_allclose(speed.dimension_values("speed"), 3.6 * run.speed_ms)
    np.testing.assert_allclose(energy.dimension_values("energy"), run.supply_energy_j / 3.6e6)
    np.testing.assert_allclose(effort.dimension_values("effort")[1:], run.effort_n / 1e3)


def test_all_charts_of_a_run_share_one_x_axis(run: Trajectory) -> None:
    figures = drawn(to_holoviews(run))
    assert len(figures) == 3
    assert len({f.x_range.id for f in figures}) == 1
    assert len({f.y_range.id for f in figures}) == 3
    assert (figures[0].x_range.start, figures[0].x_range.end) == (0, 2000)  # the line of `plain_scenario`


def test_effort_is_drawn_as_steps_that_end_at_their_node_and_has_a_zero_line(run: Trajectory) -> None:
    speed, _, effort = to_holoviews(run)
    assert [hv.Store.lookup_options("bokeh", one, "plot").kwargs["interpolation"] for one in (speed, effort)] == [
        "linear",
        "steps-pre",
    ]
    zeros = [[one for one in f.center if isinstance(one, Span)] for f in drawn(to_holoviews(run))]
    assert [len(one) for one in zeros] == [0, 0, 1]
    assert zeros[2][0].location == 0


@pytest.mark.parametrize("dark", [False, True])
def test_figures_wear_the_colours_of_the_theme(run: Trajectory, fastest: Trajectory, dark: bool) -> None:
    tokens = THEMES["dark" if dark else "light"]
    for f in drawn(to_holoviews(run, dark=dark)):
        assert (f.background_fill_color, f.border_fill_color) == (tokens["surface"], tokens["surface"])
        assert (f.title.text_color, f.xaxis[0].major_label_text_color) == (tokens["ink2"], tokens["ink3"])
        assert [line.glyph.line_color for line in f.renderers] == [tokens["optimal"]]
    (f,) = drawn(compare([run, fastest], dark=dark))
    assert [line.glyph.line_color for line in f.renderers] == [tokens["optimal"], tokens["fastest"]]
    assert [line.glyph.line_dash for line in f.renderers] == [[], DASHES["fastest"]]
    assert (f.legend[0].background_fill_color, f.legend[0].label_text_color) == (tokens["surface"], tokens["ink2"])


def test_runs_have_the_names_of_their_strategies_or_those_given(run: Trajectory, fastest: Trajectory) -> None:
    for runs, names in (
        ([run, fastest], ["Optimal", "Fastest"]),
        ({"50 % more time": run, "no time to lose, <b>": fastest}, ["50 % more time", "no time to lose, <b>"]),
    ):
        (f,) = drawn(compare(runs))
        assert [item.label.value for item in f.legend[0].items] == names
        assert [tool.tooltips[0] for tool in f.tools if isinstance(tool, HoverTool)] == [
            ("Run", name) for name in names
        ]


def test_runs_of_one_strategy_are_told_apart(run: Trajectory) -> None:
    (f,) = drawn(compare({str(number): run for number in range(9)}))
    worn = [(line.glyph.line_color, tuple(line.glyph.line_dash)) for line in f.renderers]
    pins = [(THEMES["light"][token], tuple(dash)) for token, dash in PIN_DASHES.items()]
    assert worn == [(THEMES["light"]["optimal"], ()), *pins, *pins[:2]]


def test_any_quantity_can_be_compared(run: Trajectory, fastest: Trajectory) -> None:
    shown = compare([run, fastest], ENERGY)
    assert [curve.vdims[0].name for curve in shown] == ["energy", "energy"]
    assert drawn(shown)[0].title.text == ENERGY.words


def test_an_axis_begins_at_zero_unless_values_lie_below(run: Trajectory) -> None:
    speed, _, effort = drawn(to_holoviews(run))
    assert speed.y_range.start == 0
    assert speed.y_range.end > np.max(SPEED.values(run))
    assert effort.y_range.start < np.min(run.effort_n) / 1e3


def test_what_cannot_be_named_is_refused_in_one_sentence(run: Trajectory) -> None:
    for runs, sentence in (
        ([], r"runs: there is none; at least one run is needed\."),
        ([run, run], r"runs: two have the strategy 'optimal'; give a dict of the runs by name\."),
        ({" ": run}, r"runs: a name is empty; each run needs one for the legend\."),
    ):
        with pytest.raises(ValueError, match=f"^{sentence}$"):
            compare(runs)


def test_two_readers_share_no_model(run: Trajectory) -> None:
    one, other = (hv.render(to_holoviews(run), backend="bokeh").references() for _ in range(2))
    assert one.isdisjoint(other)
    shown = to_holoviews(run)
    one, other = (hv.render(shown, backend="bokeh").references() for _ in range(2))
    assert one.isdisjoint(other)


def test_the_example_runs_and_its_outputs_are_those_kept() -> None:
    """`python -m tests.example_notebook` renews them; their energies are of the solver, so this guards change only."""
    assert executed() == json.loads(PATH.read_text(encoding="utf-8"))
