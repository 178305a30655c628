"""What all work behind a page does alike."""

from typing import Any

import param
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError
from railjoule.dashboard.state.page_model import PageModel
from railjoule.dashboard.state.page_work import Items, PageWork
from railjoule.dashboard.state.workbench import Workbench


class Model(PageModel):
    busy = param.Boolean(default=False)


class Work(PageWork[Model]):
    page = "Motor"
    at_rest = {"busy": False}  # noqa: RUF012


@pytest.fixture
def work() -> Work:
    return Work(Workbench(), Model())


def test_nothing_is_asked_for_twice_until_the_scenario_is_another(work: Work) -> None:
    assert [work.is_new(1), work.is_new(1), work.is_new(2), work.is_new(2, "other")] == [True, False, True, True]
    work.state.scenario.edit({"vehicle.auxiliary_power_kw": 40.0})
    assert not work.is_new(2)
    work.state.scenario.choose("liashenko-i")
    assert work.is_new(2)


def test_quiet_ends_where_it_began_whatever_happens(work: Work) -> None:
    def fail() -> None:
        with work.quiet():
            with work.quiet():
                pass
            assert work._quiet
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert not work._quiet


def test_an_error_reaches_the_page_with_nothing_under_way(work: Work) -> None:
    def fail(_: int) -> int:
        raise RailjouleError("No run.")

    work.model.busy = True
    work.worker(fail, lambda _: None).ask(1)
    assert str(work.model.failure) == "No run."
    assert not work.model.busy


def test_the_end_ends_studies_and_what_waits(work: Work) -> None:
    steps: list[int] = []
    document, acted = Document(), list[str]()
    work.study(lambda count: iter(range(count)), lambda step, last: steps.append(step)).ask(2)
    assert steps == [0, 1, 1]
    work.after(10, lambda: acted.append("without a page"))
    with set_curdoc(document):
        work.after(10, lambda: acted.append("ended"))
        work.end()
        work.after(10, lambda: acted.append("at rest"))
    for callback in document.session_callbacks:
        callback.callback()
    assert acted == ["without a page", "at rest"]


def test_each_model_of_a_list_is_listened_to_once() -> None:
    heard: list[Any] = []
    one, other = Model(), Model()
    items = Items(lambda event: heard.append(event.obj))
    items.follow([one], lambda _: ["busy"])
    items.follow([one, other], lambda _: ["busy"])
    one.busy = True
    other.busy = True
    assert heard == [one, other]
