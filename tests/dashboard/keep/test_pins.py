import time
from collections.abc import Callable

from railjoule.dashboard.keep.link import read_link, write_link
from railjoule.dashboard.keep.pins import Pins
from railjoule.dashboard.keep.snapshot import lay, snapshot_of
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import RunsRequest, compute_runs

PATIENCE_S = 60


def opened() -> Workbench:
    """Return the state of a page whose pins are kept."""
    state = Workbench()
    Pins(state)
    return state


def await_(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def pin(state: Workbench, **changes: float) -> None:
    state.scenario.edit({key.replace("__", "."): value for key, value in changes.items()})
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn))
    state.pin()


def test_pins_come_back_from_an_address() -> None:
    state = opened()
    pin(state, vehicle__load_factor=0.2)
    pin(state, vehicle__load_factor=0.9)
    state.rename(state.pins[0], "Nearly empty")
    snapshot = snapshot_of(state)
    other = opened()
    assert lay(other, read_link(write_link(snapshot, snapshot_of(Workbench()))).snapshot) == ()
    await_(lambda: len(other.pins) == 2)
    assert [one.name for one in other.pins] == [one.name for one in state.pins]
    for one, was in zip(other.pins, state.pins, strict=True):
        assert one.colour == was.colour
        assert one.trajectory.scenario == was.trajectory.scenario
        assert abs(one.trajectory.energy_kwh - was.trajectory.energy_kwh) < 1e-9


def test_a_pin_that_cannot_be_run_is_told_and_the_others_stay() -> None:
    state = opened()
    pin(state, vehicle__load_factor=0.2)
    kept = state.kept_pins[0].keep()
    lay(state, snapshot_of(state) | {"kept_pins": [{**kept, "changes": {"timetable.travel_time_s": 5.0}}]})
    await_(lambda: bool(state.notice))
    assert state.notice.startswith("What was pinned cannot be run again: ")
    assert [one.keep() for one in state.kept_pins] == [kept]


def test_seven_pins_of_an_address_are_refused() -> None:
    state = opened()
    lay(state, snapshot_of(state) | {"kept_pins": [{"preset": "liashenko-i"}] * 7})
    assert "At most 6 runs can be pinned" in state.notice
    assert state.kept_pins == []
