"""What the browser is sent of a run: each column once, and only what has changed."""

from types import SimpleNamespace

import numpy as np
import pytest
from bokeh.document import Document
from bokeh.document.events import ColumnDataChangedEvent

from railjoule.dashboard.charts.axis import RunColumns
from railjoule.dashboard.charts.quantities import EFFORT, MOTOR_CURRENT, SPEED, at_nodes, read

COUNT = 100


@pytest.fixture
def columns() -> tuple[RunColumns, list[set[str]]]:
    """Columns in a document, and the names of those that each change sends."""
    columns, told = RunColumns(np.float32), []
    document = Document()
    document.add_root(columns.source)

    def note(event: object) -> None:
        assert isinstance(event, ColumnDataChangedEvent)
        assert event.cols is not None
        told.append(set(event.cols))

    columns.declare("position", "speed")
    document.on_change(note)
    return columns, told


def rising(count: int = COUNT) -> np.ndarray:
    return np.linspace(0, 1, count)


def test_what_all_charts_take_goes_at_once_in_half_the_size(columns: tuple[RunColumns, list[set[str]]]) -> None:
    run, told = columns
    driven = object()
    run.take(driven, {"position": rising(), "speed": 60 * rising()})
    run.take(driven, {"position": rising(), "energy": rising() ** 2})
    run.send()
    assert told == [{"position", "speed", "energy"}]
    assert {column.dtype for column in run.source.data.values()} == {np.dtype(np.float32)}


def test_what_stays_as_it_is_is_not_sent_again(columns: tuple[RunColumns, list[set[str]]]) -> None:
    run, told = columns
    run.take("first", {"position": rising(), "speed": rising()})
    run.send()
    run.take("second", {"position": rising(), "speed": 2 * rising()})
    run.send()
    run.take("second", {"position": rising(), "speed": 2 * rising()})
    run.send()
    assert told[1:] == [{"speed"}]


def test_what_no_chart_in_sight_draws_is_not_sent(columns: tuple[RunColumns, list[set[str]]]) -> None:
    run, told = columns
    run.take("first", {"position": rising(), "speed": rising(), "effort": rising()})
    run.send()
    run.take("second", {"position": 2 * rising(), "speed": 3 * rising()})
    run.send()
    assert told[1:] == [{"position", "speed"}]
    # where the run has more nodes than before, all columns must be as long: the one out of sight in single bytes
    run.take("third", {"position": rising(COUNT + 1), "speed": rising(COUNT + 1)})
    run.send()
    assert {len(column) for column in run.source.data.values()} == {COUNT + 1}
    assert run.source.data["effort"].itemsize == 1


def test_columns_of_an_earlier_run_are_forgotten_before_they_are_sent(
    columns: tuple[RunColumns, list[set[str]]],
) -> None:
    run, told = columns
    run.take("first", {"position": rising(), "energy": rising()})
    run.take("second", {"position": rising(), "speed": rising()})
    run.send()
    assert told == [{"position", "speed"}]


def test_short_columns_travel_as_lists(columns: tuple[RunColumns, list[set[str]]]) -> None:
    run, _ = columns
    run.take("first", {"position": rising(3), "speed": rising(3)})
    run.send()
    assert run.source.data["position"] == [0.0, 0.5, 1.0]


def test_each_node_has_the_value_of_the_cell_before_it() -> None:
    assert list(at_nodes(np.array([3.0, 5.0]))) == [3.0, 3.0, 5.0]
    run = SimpleNamespace(effort_n=np.array([2e3, -1e3]), time_s=np.zeros(3))
    assert list(EFFORT.values(run)) == [2.0, 2.0, -1.0]


def test_what_a_run_does_not_know_is_zero_in_each_node() -> None:
    assert list(MOTOR_CURRENT.values(SimpleNamespace(current_a=None, time_s=np.zeros(3)))) == [0.0] * 3


def test_values_are_in_the_unit_that_is_told() -> None:
    # 10 m/s are 36 km/h
    assert SPEED.values(SimpleNamespace(speed_ms=np.array([0.0, 10.0]))) == pytest.approx([0.0, 36.0])


def test_a_limit_that_never_changes_counts_at_all_times() -> None:
    run = SimpleNamespace(voltage_limit_v=400.0, time_s=np.zeros(3))
    assert list(read("voltage_limit_v")(run)) == [400.0] * 3
