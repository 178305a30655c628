"""The mesh: nodes on every change of the line, no cell longer than asked, shorter ones at the stops."""

import re
import tracemalloc

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError
from railjoule.core.budget import LIBRARY
from railjoule.core.motion.mesh import (
    HALVINGS,
    SHORTEST_CELL_M,
    enough_words,
    line_borders,
    line_mesh,
    with_nodes_at,
)
from railjoule.core.scenario import Line, preset_document

LINE = Line.model_validate(
    {
        "sections": HILLS,
        "speed_limits": [{"from_m": 333.3, "to_m": 777.7, "limit_kmh": 50}],
        "stations": [{"position_m": 1000.5}],
    }
)
CHANGES = [0.0, 333.3, 400.0, 700.0, 777.7, 1000.5, 1200.0, 1700.0, 2000.0]


def test_borders_are_all_changes_of_the_line():
    assert line_borders(LINE) == pytest.approx(CHANGES)


def test_changes_in_one_place_are_one_border():
    sections = [{"length_m": 0.1}] * 20
    limits = [{"from_m": 0.3, "to_m": 1.1, "limit_kmh": 50}]
    borders = line_borders(Line.model_validate({"sections": sections, "speed_limits": limits}))
    assert len(borders) == 21  # 0.1 + 0.1 + 0.1 is not 0.3
    assert (np.diff(borders) > 0.09).all()


def test_the_end_stays_where_it_is():
    line = Line.model_validate({"sections": [{"length_m": 1000}, {"length_m": 1e-7}]})
    assert line_mesh(line, 10)[-1] == line.length_m


@given(st.floats(1, 500))
def test_nodes_fall_on_changes_and_cells_are_short_enough(mesh_m):
    nodes = line_mesh(LINE, mesh_m)
    assert (np.diff(nodes) > 0).all()
    assert np.diff(nodes).max() <= mesh_m * (1 + 1e-9)
    for place in CHANGES:
        assert np.abs(nodes - place).min() < 1e-6


def test_cells_are_halved_towards_every_stop():
    nodes = line_mesh(Line.model_validate({"sections": [{"length_m": 100}], "stations": [{"position_m": 50}]}), 10)
    shares = 10 * 0.5 ** np.arange(HALVINGS + 1)
    first = np.append(0, shares[::-1])
    around = np.concatenate([50 - shares, [50], 50 + shares[::-1]])
    expected = np.unique(np.concatenate([first, [20, 30, 40], around, [60, 70, 80], 100 - first]))
    assert nodes == pytest.approx(expected)


def test_a_line_of_one_cell():
    assert line_mesh(Line.model_validate({"sections": [{"length_m": 8}]}), 10) == pytest.approx([0, 1, 2, 4, 6, 7, 8])


def test_a_mesh_of_more_than_200000_cells():
    line = plain_scenario({"line.sections": [{"length_m": 200e3}]}).line
    assert len(line_mesh(line, 1)) == LIBRARY.cell_count + 1 + 6
    with pytest.raises(ScenarioError) as error:
        line_mesh(line, 0.9999)
    assert str(error.value) == (
        "solver.mesh_m = 0.9999 makes 200,021 cells; railjoule takes at most 200,000. Use 1.1 m or more."
    )


def test_a_line_of_too_many_sections():
    line = Line.model_validate({"sections": [{"length_m": 1}] * 2000})
    assert enough_words(line, 1000) == ", and sections, limits and stops of the line already make 2,006."


@given(st.integers(100, 5000), st.sampled_from(["metro-10-stations", "liashenko-ii", "flat-950m"]))
def test_the_mesh_that_is_recommended_is_enough(most, preset):
    line = Line.model_validate(preset_document("lines", preset))
    enough_m = float(re.search(r"Use (\S+) m", enough_words(line, most))[1])
    assert len(line_mesh(line, enough_m)) - 1 <= most


def brute_force(position_m, places_m):
    """Measure the distance of each node from each place."""
    distance = np.abs(position_m[:, None] - places_m[None, :]).min(axis=1, initial=np.inf)
    distance[[0, -1]] = np.inf
    return np.union1d(position_m[distance > SHORTEST_CELL_M], places_m)


NEAR = st.sampled_from([0.0, 1e-7, -1e-7, SHORTEST_CELL_M, -SHORTEST_CELL_M, 2e-6, -2e-6])
NODES = st.lists(st.integers(0, 30), min_size=2, max_size=20, unique=True).map(lambda nodes: np.sort(nodes) / 3)


@given(NODES, st.lists(st.tuples(st.integers(0, 60), NEAR), max_size=30))
def test_nodes_at_places_are_those_of_the_plain_rule(position_m, places):
    places_m = np.array([place / 6 + near for place, near in places])
    assert np.array_equal(with_nodes_at(position_m, places_m), brute_force(position_m, places_m))


@pytest.mark.parametrize("count", [50_000, 200_000])
def test_many_nodes_at_many_places_take_memory_in_proportion(count):
    random = np.random.default_rng(1)
    position_m, places_m = np.linspace(0, 1e5, count), random.random(count) * 1e5
    tracemalloc.start()
    with_nodes_at(position_m, places_m)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 250 * count  # bytes: 50 MB for 200,000; all distances at once would be 320 GB
