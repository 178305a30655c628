"""From three spreadsheets and a recorder's file to the report, by mouse alone; and what Import says of other files."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.server import Server
from browser.user import User, open_page
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.keep.embedded import scenario_in_report
from railjoule.dashboard.pages.imports.compute import examples

CANARY = "</style><img src=x onerror='window.pwned=true'>"
LONGEST_WALK_S = 300.0
"""What a new user is to need at most; the mouse of a test is faster, the machine may be slower."""
ASSETS = Path(__file__).parents[2] / "assets"


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user for all tests of this file, who begins on Start."""
    with User.on(window, server.url, on_drive=False) as someone:
        yield someone


@pytest.fixture
def spreadsheets(tmp_path: Path) -> list[Path]:
    """Three spreadsheets in the columns that SNCF publishes, as they would lie in a folder of downloads."""
    paths = [tmp_path / source.name for source in examples()]
    for path, source in zip(paths, examples(), strict=True):
        path.write_bytes(source.content)
    return paths


@pytest.fixture
def recorder_file() -> Path:
    """Return the shipped file of a recorder, in French: current and voltage, but no power."""
    return ASSETS / "imports" / "example-recorder.csv"


def card(user: User, name: str) -> Locator:
    return user.page.get_by_role("region", name=name, exact=True)


def bring(user: User, *paths: Path) -> None:
    with user.page.expect_file_chooser() as chosen:
        user.page.get_by_role("button", name="Choose files").click()
    chosen.value.set_files(list(paths))


def test_from_three_spreadsheets_and_a_recorders_file_to_the_report(
    user: User, spreadsheets: list[Path], recorder_file: Path, tmp_path: Path
) -> None:
    page, began = user.page, time.monotonic()
    page.get_by_role("button", name="Bring your own line").click()
    expect(user.question("Import")).to_be_visible()
    bring(user, *spreadsheets)
    for name, kind in (("limits", "limits"), ("gradients", "gradients"), ("curves", "curves")):
        expect(page.get_by_label(f"What example-{name}.csv is")).to_have_value(kind)
    gradients = card(user, "example-gradients.csv")
    expect(gradients.get_by_role("alert")).to_contain_text("its rows are of several NOM_VOIE: V1, V2; choose one.")
    # a metro would drive on level track
    expect(page.get_by_role("button", name="Take this line", exact=True)).to_be_disabled()
    expect(page.get_by_role("button", name="Take this line without the gradients")).to_be_enabled()
    page.get_by_label("Only NOM_VOIE: example-gradients.csv").select_option("V1")
    expect(gradients.get_by_role("alert")).to_have_count(0)
    expect(gradients).to_contain_text("Nothing from 18,900 to 19,100 m")
    expect(page.get_by_role("heading", name="Line of example-limits: 12.00 km")).to_be_visible()
    for chart in ("import_height", "import_limits", "import_curves"):
        expect(page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    take = page.get_by_role("button", name="Take this line", exact=True)
    expect(take).to_be_enabled()
    expect(page.get_by_text("1.1 \u00d7 the shortest")).to_be_visible()
    take.click()
    expect(user.question("Drive")).to_be_visible()
    expect(user.scenario("Line of example-limits, Metro 81-7036, 5 cars")).to_be_visible()
    user.see_drive()
    open_page(user, "Measured runs")
    with page.expect_file_chooser() as file:
        page.locator("label:visible", has_text="Choose files").click()
    file.value.set_files(recorder_file)
    # the sum of current times voltage, and the model of the same train
    expect(user.figure_value("Measured")).not_to_have_text("\u2014")
    expect(user.figure_value("Could save")).to_have_text(re.compile(r"1[5-9]\.\d%"))
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
    open_page(user, "Import")
    bad = tmp_path / "limits.csv"
    bad.write_text(f"from,to,{CANARY}\n0,{CANARY},80\n")
    bring(user, bad)
    expect(card(user, "limits.csv").get_by_role("alert")).to_contain_text("limits.csv: ")
    large = tmp_path / "large.csv"
    large.write_bytes(b"0" * 4_000_001)
    bring(user, large)
    expect(page.get_by_text("large.csv: larger than the 4 MB allowed for one file.")).to_be_visible()
    assert page.evaluate("window.pwned === undefined")
    page.get_by_role("button", name="Remove limits.csv").click()
