"""What the browser is sent of a run: each column once, and only what has changed."""

import numpy as np
import pytest
from bokeh.document import Document
from bokeh.document.events import ColumnDataChangedEvent

from railjoule.dashboard.charts.run_columns import RunColumns

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
