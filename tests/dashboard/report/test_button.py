import pytest

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.report.button import ReportButton
from railjoule.dashboard.report.contents import Contents, ContentsError
from railjoule.dashboard.report.form import contents_of
from railjoule.dashboard.report.model import ReportingModel
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.state.workbench import Workbench


class Asked:
    """The button of a page, and how often a report was asked for."""

    def __init__(self) -> None:
        self.model, self.count = ReportingModel(), 0
        self.browser, self.state = Browser(), Workbench()
        self.button = ReportButton(self.model, self.browser, self.state, stack())
        self.model.param.watch(self._note, "wanted")
        self.press()

    def press(self) -> None:
        self.browser._handle_msg({"kind": "report"})

    def _note(self, *_: object) -> None:
        self.count += 1

    def send(self, **message: object) -> None:
        self.button.form._handle_msg(message)


def test_a_report_is_made_as_it_was_asked_for() -> None:
    asked = Asked()
    asked.send(what="make", sections=list(SECTION_TITLES), author="", note="")
    assert asked.model.contents == Contents(tuple(SECTION_TITLES))
    asked.press()
    asked.send(what="make", sections=["proof"], author="A.", note="One")
    assert asked.model.contents == Contents(("proof",), "A.", "One")
    assert asked.count == 2
    assert not asked.button.form.open


def test_a_refusal_keeps_the_form_open_until_it_is_mended() -> None:
    asked = Asked()
    asked.send(what="make", sections=["proof"], author="", note="x" * 2001)
    assert asked.button.form.refusal == "note: has 2,001 characters, at most 2,000 are allowed."
    assert asked.button.form.open
    assert asked.count == 0
    asked.send(what="make", sections=["proof"], author="", note="x")
    assert asked.button.form.refusal == ""
    assert asked.count == 1


def test_a_report_under_way_is_shown_and_stopped_by_its_button() -> None:
    asked, stopped = Asked(), []
    asked.model.param.watch(stopped.append, "unwanted")
    asked.model.param.update(busy=True, share=0.25)
    assert (asked.browser.progress, asked.browser.labels["report"]) == (0.25, "Stop report")
    asked.press()
    assert len(stopped) == 1
    asked.model.busy = False
    assert (asked.browser.progress, asked.browser.labels["report"]) == (None, "Report")
    asked.model.failure = ContentsError("too long")
    assert asked.state.notice == "There is no report: too long"


def test_a_message_becomes_contents() -> None:
    message = {"what": "make", "sections": ["proof", "file"], "author": " A. ", "note": "\nOne\n\nTwo\n"}
    assert contents_of(message) == Contents(("proof", "file"), "A.", "One\n\nTwo")


@pytest.mark.parametrize("sections", [None, 3, "result", [], [["result"]], [None]])
def test_a_message_with_other_sections_is_refused(sections: object) -> None:
    with pytest.raises(ContentsError, match=r"^sections: "):
        contents_of({"sections": sections, "author": None, "note": None})
