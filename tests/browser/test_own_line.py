"""From three spreadsheets and a recorder's file to the report, by mouse alone; and what Files says of others."""

import re
import time
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from browser.user import User, open_page
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.keep.dropped import scenario_in_report
from railjoule.dashboard.pages.files.page import EXAMPLE_LINE, sources

CANARY = "</style><img src=x onerror='window.pwned=true'>"
LONGEST_WALK_S = 300.0
"""What a new user is to need at most; the mouse of a test is faster, the machine may be slower."""
ASSETS = Path(__file__).parents[2] / "assets"


LINK = "?v=1&page=Start"


@pytest.fixture
def spreadsheets(tmp_path: Path) -> list[Path]:
    """Three spreadsheets in the columns that SNCF publishes, as they would lie in a folder of downloads."""
    paths = [tmp_path / source.name for source in sources(EXAMPLE_LINE)]
    for path, source in zip(paths, sources(EXAMPLE_LINE), strict=True):
        path.write_bytes(source.content)
    return paths


@pytest.fixture
def recorder_file() -> Path:
    """Return the shipped file of a recorder, in French: current and voltage, but no power."""
    return ASSETS / "imports" / "example-recorder.csv"


def bring(user: User, *paths: Path) -> None:
    with user.page.expect_file_chooser() as chosen:
        user.page.locator("label:visible", has_text="Choose files").click()
    chosen.value.set_files(list(paths))


def menu(user: User, label: str) -> Locator:
    return user.page.get_by_role("combobox", name=label, exact=True)


def test_from_three_spreadsheets_and_a_recorders_file_to_the_report(
    user: User, spreadsheets: list[Path], recorder_file: Path, tmp_path: Path
) -> None:
    page, began = user.page, time.monotonic()
    page.get_by_role("button", name="Use your own line, train or file").click()
    expect(user.question("Files")).to_be_visible()
    bring(user, *spreadsheets)
    for k, kind in enumerate(("Speed limits", "Gradients", "Curves")):
        expect(menu(user, "Kind of file").nth(k)).to_have_value(kind)
    several = page.get_by_text("its rows are of several NOM_VOIE: V1, V2; choose one.")
    expect(several).to_be_visible()
    # a metro would drive on level track
    expect(page.get_by_role("button", name="Use this line", exact=True)).to_be_disabled()
    expect(page.get_by_role("button", name="Use this line without the gradients")).to_be_enabled()
    menu(user, "Only NOM_VOIE").select_option("V1")
    expect(several).to_have_count(0)
    expect(page.get_by_text("Nothing from 18,900 to 19,100 m").first).to_be_visible()
    expect(page.get_by_role("heading", name="Line of example-limits: 12.00 km")).to_be_visible()
    for chart in ("import_height", "import_limits", "import_curves"):
        expect(page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    take = page.get_by_role("button", name="Use this line", exact=True)
    expect(take).to_be_enabled()
    expect(page.get_by_text("proposed: 1.1 \u00d7 the shortest")).to_be_visible()
    take.click()
    expect(user.question("Drive")).to_be_visible()
    expect(user.scenario("Line of example-limits, Metro 81-7036, 5 cars")).to_be_visible()
    user.see_drive()
    open_page(user, "Files")
    bring(user, recorder_file)
    # the sum of current times voltage, and the model of the same train
    expect(user.figure_value("Measured")).not_to_have_text("\u2014")
    expect(user.figure_value("Potential saving")).to_have_text(re.compile(r"1[5-9]\.\d%"))
    expect(page.get_by_text("The electric power is the line current times the line voltage")).to_be_visible()
    expect(page.get_by_text("proven for the modelled train").first).to_be_visible()
    measured = user.number("Measured")
    page.get_by_role("button", name="Pin this run").click()
    expect(page.get_by_role("button", name="Unpin this run")).to_be_visible()
    open_page(user, "Compare")
    expect(page.get_by_role("cell", name=re.compile(r"^1 Measured, \d+\.\d s, example-recorder.csv$"))).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("button", name="Report", exact=True).click()
        page.get_by_role("button", name="Make the report").click()
    report = tmp_path / "report.html"
    download.value.save_as(report)
    assert time.monotonic() - began < LONGEST_WALK_S
    text = report.read_text(encoding="utf-8")
    assert '<section id="pinned"' in text
    assert "example-recorder.csv" in text
    assert measured.split("\n")[0].split("kWh")[0].strip() in text
    scenario = parse_scenario(scenario_in_report(text, "report"), "report")
    assert scenario.line.length_m == 12_000
    assert scenario.vehicle.name == "Metro 81-7036, 5 cars"


def test_hostile_files_get_a_sentence(user: User, tmp_path: Path) -> None:
    page = user.page
    open_page(user, "Files")
    bad, large = tmp_path / "limits.csv", tmp_path / "large.csv"
    bad.write_text(f"from,to,{CANARY}\n0,{CANARY},80\n")
    large.write_bytes(b"0" * 8_000_001)
    bring(user, bad)
    expect(page.get_by_role("alert").filter(has_text="limits.csv: ").first).to_be_visible()
    bring(user, large)
    expect(page.get_by_text("larger than the 8 MB that a file may have.")).to_be_visible()
    assert page.evaluate("window.pwned === undefined")
    page.get_by_role("button", name="Remove limits.csv").click()
