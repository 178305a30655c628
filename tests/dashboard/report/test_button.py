from railjoule.dashboard.browser import Browser
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.report.button import ReportButton, ReportForm
from railjoule.dashboard.report.contents import Contents, ContentsError
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.work import ReportingModel
from railjoule.dashboard.workbench import Workbench


class Asked:
    """The button of a page, and how many reports were requested."""

    def __init__(self) -> None:
        self.model, self.count = ReportingModel(), 0
        self.browser, self.state, self.place = Browser(), Workbench(), stack()
        self.button = ReportButton(self.model, self.browser, self.state, self.place)
        self.model.param.watch(self._note, "wanted")

    def _note(self, *_: object) -> None:
        self.count += 1

    def press(self) -> None:
        self.browser._handle_msg({"kind": "report"})

    def open(self) -> ReportForm:
        self.press()
        form = self.button.form
        assert form.dialog.open
        return form


def test_a_page_has_no_form_before_it_is_opened() -> None:
    asked = Asked()
    assert asked.button.form is None
    assert not asked.place.objects


def test_a_report_is_made_as_it_was_requested() -> None:
    asked = Asked()
    form = asked.open()
    form.make.clicks += 1
    assert asked.model.contents == Contents(tuple(SECTION_TITLES))
    assert not form.dialog.open
    asked.press()
    assert asked.button.form is form
    form.sections.value, form.author.value, form.note.value = ["proof"], " A. ", "\nOne\n\nTwo\n"
    form.make.clicks += 1
    assert asked.model.contents == Contents(("proof",), "A.", "One\n\nTwo")
    assert asked.count == 2


def test_a_refusal_keeps_the_form_open() -> None:
    asked = Asked()
    form = asked.open()
    form.sections.value, form.note.value = ["proof"], "x" * 2001
    form.make.clicks += 1
    refusal = form.refusal.object.replace("<b>", "").replace("</b>", "")
    assert "note: has 2,001 characters, at most 2,000 are permitted." in refusal
    assert form.refusal.visible
    assert form.dialog.open
    form.sections.value, form.note.value = [], ""
    form.make.clicks += 1
    assert "a report has at least one of" in form.refusal.object
    assert asked.count == 0
    form.sections.value = ["proof"]
    form.make.clicks += 1
    assert asked.count == 1
    asked.open()
    assert not form.refusal.visible


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
