import pytest

from railjoule.dashboard.report.contents import Contents, ContentsError
from railjoule.dashboard.report.form import ReportForm, contents_of
from railjoule.dashboard.report.section_names import SECTION_TITLES


def test_a_message_becomes_contents() -> None:
    message = {"what": "make", "sections": ["proof", "file"], "author": " A. ", "note": "\nOne\n\nTwo\n"}
    assert contents_of(message) == Contents(("proof", "file"), "A.", "One\n\nTwo")


@pytest.mark.parametrize("sections", [None, 3, "result", [], [["result"]], [None]])
def test_a_message_with_other_sections_is_refused(sections: object) -> None:
    with pytest.raises(ContentsError, match=r"^sections: "):
        contents_of({"sections": sections, "author": None, "note": None})


def test_the_form_offers_all_sections() -> None:
    form = ReportForm(lambda _: None)
    assert dict(form.sections) == SECTION_TITLES
    assert not form.open
