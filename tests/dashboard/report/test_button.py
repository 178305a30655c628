import pytest

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.report.button import ReportButton
from railjoule.dashboard.report.contents import Contents, ContentsError
from railjoule.dashboard.report.form import contents_of
from railjoule.dashboard.report.model import ReportingModel
from railjoule.dashboard.report.section_names import SECTION_TITLES


class Asked:
    """The button of a page, and how often a report was asked for."""

    def __init__(self) -> None:
        self.model, self.count = ReportingModel(), 0
        self.button = ReportButton(self.model, Browser(), lambda *_: None)
        self.model.param.watch(self._note, "wanted")
        self.button.button.clicks += 1

    def _note(self, *_: object) -> None:
        self.count += 1

    def send(self, **message: object) -> None:
        self.button.form._handle_msg(message)


def test_a_report_is_made_as_it_was_asked_for() -> None:
    asked = Asked()
    asked.send(what="make", sections=list(SECTION_TITLES), author="", note="")
    assert asked.model.contents == Contents(tuple(SECTION_TITLES))
    asked.button.small.clicks += 1
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


def test_a_message_becomes_contents() -> None:
    message = {"what": "make", "sections": ["proof", "file"], "author": " A. ", "note": "\nOne\n\nTwo\n"}
    assert contents_of(message) == Contents(("proof", "file"), "A.", "One\n\nTwo")


@pytest.mark.parametrize("sections", [None, 3, "result", [], [["result"]], [None]])
def test_a_message_with_other_sections_is_refused(sections: object) -> None:
    with pytest.raises(ContentsError, match=r"^sections: "):
        contents_of({"sections": sections, "author": None, "note": None})
