import time
from collections.abc import Callable

from railjoule.dashboard.keep.link import read_link, write_link
from railjoule.dashboard.keep.pins import Pins
from railjoule.dashboard.keep.snapshot import lay, snapshot_of
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench

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
    assert state.notice.startswith("The pinned runs cannot be computed again: ")
    assert [one.keep() for one in state.kept_pins] == [kept]


def test_seven_pins_of_an_address_are_refused() -> None:
    state = opened()
    lay(state, snapshot_of(state) | {"kept_pins": [{"preset": "liashenko-i"}] * 7})
    assert "At most 6 runs can be pinned" in state.notice
    assert state.kept_pins == []


def test_a_measured_run_comes_back_by_a_step_back_and_is_in_no_link() -> None:
    state = opened()
    state.page = "Files"
    page = state.pages["Files"]
    PageWorks(page)
    page.tab = "runs"
    page.try_example()
    assert page.run is not None
    state.pin_measured(page.run)
    state.pin_measured(page.run)
    (pinned,) = state.pins
    assert pinned.trajectory is page.run.trajectory
    assert pinned.name == "Measured, 171.0 s, metro-0714.csv"
    pin(state, vehicle__load_factor=0.2)
    snapshot = snapshot_of(state)
    state.unpin(pinned)
    assert lay(state, snapshot) == ()
    await_(lambda: len(state.pins) == 2)
    assert state.pins[0].trajectory is pinned.trajectory
    # another page does not have the file: the other pin is run again, and the loss is told
    other = opened()
    lay(other, read_link(write_link(snapshot, snapshot_of(Workbench()))).snapshot)
    await_(lambda: len(other.pins) == 1)
    assert other.pins[0].name == state.pins[1].name
    assert other.notice.startswith("No longer pinned: Measured, 171.0 s, metro-0714.csv. ")
