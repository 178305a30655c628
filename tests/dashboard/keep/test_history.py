import pytest

from railjoule.dashboard.keep.snapshot import MAX_STEPS, ONE_MOVE_S, History


class Clock:
    """A clock that is set by hand."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def snapshot(page: str = "Drive", **values: float) -> dict[str, object]:
    return {"page": page, "colours": "system", "load": 50, "time": 170, **values}


def test_steps_are_taken_back_and_again(clock: Clock) -> None:
    history = History(snapshot(), clock)
    history.note(snapshot(load=60))
    history.note(snapshot(load=60, time=180))
    first, second = history.undo(), history.undo()
    assert (first["load"], first["time"]) == (60, 170)
    assert (second["load"], second["time"]) == (50, 170)
    assert history.undo() is None
    again = history.redo()
    assert (again["load"], again["time"]) == (60, 170)


def test_moves_of_one_slider_are_one_step(clock: Clock) -> None:
    history = History(snapshot(), clock)
    for load in (55, 60, 65):
        clock.now += 0.5 * ONE_MOVE_S
        history.note(snapshot(load=load))
    clock.now += 2 * ONE_MOVE_S
    history.note(snapshot(load=90))
    assert (history.undo()["load"], history.undo()["load"]) == (65, 50)


def test_turning_a_page_is_no_step_and_undo_turns_to_where_it_was_made(clock: Clock) -> None:
    history = History(snapshot(), clock)
    history.note(snapshot("What if"))
    assert not history.can_undo
    history.note(snapshot("What if", load=60))
    history.note(snapshot("Drive", load=60))
    assert history.undo()["page"] == "What if"


def test_opening_a_tab_is_no_step_and_undo_opens_the_one_where_it_was_made(clock: Clock) -> None:
    history = History({**snapshot("What if"), "what_if.tab": "load"}, clock)
    history.note({**snapshot("What if"), "what_if.tab": "events"})
    assert not history.can_undo
    history.note({**snapshot("What if", load=60), "what_if.tab": "events"})
    history.note({**snapshot("What if", load=60), "what_if.tab": "chance"})
    assert history.undo()["what_if.tab"] == "events"


def test_a_new_step_forgets_those_ahead(clock: Clock) -> None:
    history = History(snapshot(), clock)
    history.note(snapshot(load=60))
    history.undo()
    history.settle(snapshot())
    history.note(snapshot(load=70))
    assert not history.can_redo


def test_the_oldest_steps_are_forgotten(clock: Clock) -> None:
    history = History(snapshot(), clock)
    for step in range(MAX_STEPS + 20):
        clock.now += 2 * ONE_MOVE_S
        history.note(snapshot(load=step))
    count = 0
    while history.undo() is not None:
        count += 1
    assert count == MAX_STEPS
