"""What all work behind a page does alike."""

from typing import Any

import param
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError
from railjoule.dashboard.page import Page, Request, study, work
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.state.kept import Items, Kept, result
from railjoule.dashboard.workbench import Workbench


def fail(_: int) -> int:
    raise RailjouleError("No run.")


def count(steps: int) -> Any:
    yield from range(steps)


class Counted(Page):
    page = "Motor"
    number = param.Integer(default=0)
    run = result(int, "Of a number.")
    steps = result(int, "Up to a number.")
    busy = param.Boolean(default=False)

    @work("number", into="run")
    def _run(self) -> Request:
        return fail, self.number

    @study("number", into="steps", busy="busy")
    def _steps(self) -> Request:
        return (count, self.number) if self.number else None


@pytest.fixture
def page() -> Counted:
    return Counted(Workbench(page="Motor"))


@pytest.fixture
def works(page: Counted) -> PageWorks:
    return PageWorks(page)


def test_nothing_is_asked_for_twice_until_the_scenario_is_another(works: PageWorks) -> None:
    assert [works.is_new(1), works.is_new(1), works.is_new(2), works.is_new(2, "other")] == [True, False, True, True]
    works.desk.scenario.edit({"vehicle.auxiliary_power_kw": 40.0})
    assert not works.is_new(2)
    works.desk.scenario.choose("liashenko-i")
    assert works.is_new(2)


def test_quiet_ends_where_it_began_whatever_happens(works: PageWorks) -> None:
    def fail_within() -> None:
        with works.quiet():
            with works.quiet():
                pass
            assert works._quiet
            raise KeyError

    with pytest.raises(KeyError):
        fail_within()
    assert not works._quiet


def test_an_error_reaches_the_page_and_costs_no_other_result(page: Counted, works: PageWorks) -> None:
    page.number = 2
    assert str(page.failure) == "No run."
    assert page.steps == 1
    assert not page.busy


def test_the_end_ends_studies_and_what_waits(page: Counted, works: PageWorks) -> None:
    document, acted = Document(), list[str]()
    works.after(10, lambda: acted.append("without a page"))
    with set_curdoc(document):
        works.jobs["steps"].ask((count, 10**9))
        assert works.jobs["steps"].busy
        works.after(10, lambda: acted.append("ended"))
        works.end()
        assert not works.jobs["steps"].busy
        works.after(10, lambda: acted.append("at rest"))
    for callback in document.session_callbacks:
        callback.callback()
    assert acted == ["without a page", "at rest"]


class Item(Kept):
    kept = ("busy",)
    busy = param.Boolean(default=False)


def test_each_model_of_a_list_is_listened_to_once() -> None:
    heard: list[Any] = []
    one, other = Item(), Item()
    items = Items(lambda event: heard.append(event.obj))
    items.follow([one], lambda _: ["busy"])
    items.follow([one, other], lambda _: ["busy"])
    one.busy = True
    other.busy = True
    assert heard == [one, other]
