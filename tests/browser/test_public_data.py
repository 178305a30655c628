"""From a public data set to the report by mouse: the steps of the tutorial, with the names that it has in bold."""

import re
from pathlib import Path

import pytest
from documents import ROOT, text_of
from playwright.sync_api import expect

from browser.user import User, open_page
from railjoule.dashboard.report.section_names import SECTION_TITLES

LINK = "?v=1&page=Start"
FILES = [ROOT / "assets" / "imports" / f"{name}.json" for name in ("CH_StGallen_Wil", "NL_Intercity_VIRM6")]
STEPS = re.findall(
    r"^\d+\. .*(?:\n   .*)*", text_of("tutorials/public_data").partition("## The same by mouse")[2], re.M
)
KEPT = {"Result", "Scenario"}
"""Sections of the report that is made here; the page leaves the choice to the user."""
CUT = "[...document.querySelectorAll('.block')].filter(one => one.scrollWidth > one.clientWidth).map(one => one.id)"


def see_energy(user: User, step: str) -> None:
    """Wait until the page shows the energy of a step."""
    energy = re.search(r"([\d.]+) kWh", step)
    assert energy is not None
    expect(user.figure_value("Energy from the supply")).to_contain_text(energy[1])


@pytest.mark.nightly
def test_the_steps_lead_to_a_report(user: User, tmp_path: Path) -> None:
    names = [re.findall(r"\*\*(.+?)\*\*", step) for step in STEPS]
    (files,), (choose,), (noticed,), (both,), (edit, timetable, reserve, close), (linear,), (report, make) = names
    page = user.page
    open_page(user, files)
    with page.expect_file_chooser() as chosen:
        page.locator("label:visible", has_text=choose).click()
    chosen.value.set_files(FILES)
    expect(page.get_by_text("119 transitions between radii").first).to_be_visible()
    expect(page.get_by_text(noticed, exact=True)).to_be_visible()
    expect(page.get_by_text("no resistance of curves")).to_be_visible()
    page.get_by_role("button", name=both, exact=True).click()
    expect(user.question("Drive")).to_be_visible()
    see_energy(user, STEPS[3])
    page.get_by_role("button", name=edit).click()
    editor = page.get_by_role("region", name="Scenario editor")
    editor.get_by_role("button", name=re.compile(f"^{timetable}")).click()
    field = editor.get_by_label(reserve, exact=True)
    field.fill("10")
    field.press("Enter")
    see_energy(user, STEPS[4])
    page.get_by_role("button", name=close).click()
    expect(editor).to_be_hidden()
    page.get_by_label(f"Draw {linear}", exact=True).check()
    numbers = page.locator(".strategy", has_text=linear).locator(".result")
    expect(numbers).to_have_text("113.69+91.7 %")
    # a large energy beside a long name
    assert numbers.evaluate("one => one.scrollWidth <= one.clientWidth")
    page.get_by_role("button", name=report, exact=True).click()
    form = page.get_by_role("dialog", name=report)
    for title in set(SECTION_TITLES.values()) - KEPT:
        form.get_by_role("checkbox", name=title, exact=True).uncheck()
    with page.expect_download() as saved:
        form.get_by_role("button", name=make).click()
    path = tmp_path / "report.html"
    saved.value.save_as(path)
    reader = page.context.new_page()
    reader.goto(path.as_uri())
    expect(reader.locator("#result")).to_contain_text("59.30")
    expect(reader.get_by_role("columnheader", name="Curve radius, m")).to_be_visible()
    assert reader.evaluate(CUT) == []
    reader.close()
