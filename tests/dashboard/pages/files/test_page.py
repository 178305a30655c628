"""Files that are brought to the page, and what the page makes of them."""

import io
from pathlib import Path

import openpyxl
import pytest

from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.keep.link import read_link
from railjoule.dashboard.keep.snapshot import History, snapshot_of
from railjoule.dashboard.limits import LARGEST_RUN_BYTES
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.files.columns import MAX_ROWS
from railjoule.dashboard.pages.files.page import MAX_FILES, Files
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def page() -> Files:
    """The page in sight; all work is done in the test's own turn."""
    found: Files = Workbench(page="Files").pages["Files"]
    PageWorks(found)
    return found


def choose_track(page: Files) -> None:
    page.try_example()
    page.say(2, "rows NOM_VOIE", "V1")


def press(page: Files, what: str, time: str) -> None:
    page.use(next(one for one in page.reading.offers if one.what == what), time)


def test_the_example_is_taken_as_one_step_and_drive_opens(page: Files) -> None:
    desk = page.desk
    history = History(snapshot_of(desk))
    choose_track(page)
    before = snapshot_of(desk)
    press(page, "line", "700")
    assert desk.page == "Drive"
    assert desk.scenario.scenario().travel_time_s == 700
    assert desk.scenario.scenario().line.length_m == 12_000
    history.note(snapshot_of(desk))
    assert history.can_undo
    assert history.undo()["toml"] == before["toml"] is None
    assert not history.can_undo


def test_the_same_line_can_be_taken_again(page: Files) -> None:
    choose_track(page)
    press(page, "line", "11:40")
    for preset in ("liashenko-i", "metro-with-limit"):
        page.desk.scenario.choose(preset)
        page.desk.page = "Files"
        press(page, "line", "900")
        assert page.desk.scenario.scenario().line.length_m == 12_000


def test_a_line_waits_for_its_gradients(page: Files) -> None:
    page.try_example()
    (offer,) = page.reading.offers
    assert offer.waits_for == ("the gradients",)
    assert offer.waiting.startswith("It waits for the gradients, which cannot be read: ")
    # as the second button does, without them
    press(page, "line", "900")
    assert page.desk.page == "Drive"
    assert all(section.gradient_permille == 0 for section in page.desk.scenario.scenario().line.sections)


def test_a_column_is_chosen_by_hand_and_files_are_removed(page: Files) -> None:
    choose_track(page)
    page.say(1, "value", "lib_ligne")
    assert "row 2: lib_ligne = 'Invented example line'" in page.cards[0].failure
    page.say(1, "value", "v_max")
    assert [card.failure for card in page.cards] == ["", "", ""]
    for file in page.files:
        page.remove(file.number)
    assert page.reading is None


def test_a_time_that_is_none_changes_nothing(page: Files) -> None:
    choose_track(page)
    before = snapshot_of(page.desk)
    for time, sentence in (
        ("soon", "Travel time: 'soon' is not a time: "),
        ("nan", "Travel time: 'nan' is not a time: "),
        ("3", "Travel time: 3 s must be at least the shortest possible "),
    ):
        press(page, "line", time)
        assert page.refusal.startswith(sentence)
    assert snapshot_of(page.desk) == before


def test_messages_that_nobody_sends_change_nothing(page: Files) -> None:
    choose_track(page)
    files = page.files
    for number, key, value in (
        (2, "factor a.b", "inf"),
        (2, "value", "no column"),
        (1, "kind", "track"),
        (99, "value", "v_max"),
    ):
        page.say(number, key, value)
    page.remove(99)
    assert page.files == files
    assert page.desk.page == "Files"


def test_files_are_capped_in_size_and_number(page: Files) -> None:
    page.bring([("large.csv", b"a" * (LARGEST_RUN_BYTES + 1))])
    assert page.refusal == "large.csv: larger than the 8 MB that a file may have."
    for number in range(MAX_FILES + 1):
        page.add(f"{number}\n.csv", b"")
    assert len(page.files) == MAX_FILES
    assert page.refusal == f"{MAX_FILES} .csv: at most {MAX_FILES} files at a time; remove one first."


def test_another_scenario_beside_the_page_is_the_one_that_is_offered_with_the_line(page: Files) -> None:
    """The offer had the vehicle of the scenario that was chosen when the files came."""
    choose_track(page)
    page.desk.scenario.choose("tram-950m")
    (offer,) = page.reading.offers
    page.use(offer, f"{offer.time_s:g}")
    assert page.desk.scenario.scenario().vehicle.name == load_scenario("tram-950m").vehicle.name


def test_a_file_goes_to_the_tab_of_its_kind_and_a_scenario_is_opened(page: Files) -> None:
    page.bring([("run.csv", b"time_s,speed_kmh\n" + b"".join(b"%d,%d\n" % (k, k) for k in range(12)))])
    assert (page.tab, page.shown) == ("runs", "run.csv")
    page.bring([("limits.csv", b"from_m,to_m,limit_kmh\n0,500,60\n")])
    assert page.tab == "line"
    page.say(2, "kind", "gradients")
    assert [card.kind for card in page.cards] == ["run", "gradients"]
    # what cannot be read stands beside the lines, whatever it may be
    page.tab = "runs"
    page.bring([("bad.csv", b"\x00")])
    assert page.tab == "line"
    assert page.cards[-1].failure.startswith("bad.csv: not a text file")
    page.bring([("long.csv", b"time_s,speed_kmh\n" + b"1,1\n" * (MAX_ROWS + 1))])
    assert page.tab == "line"
    assert "at most 20\u202f000 can be read" in page.cards[-1].failure
    page.bring([("mine.toml", b"no scenario")])
    assert page.refusal
    page.bring([("mine.toml", format_scenario(load_scenario("liashenko-i")).encode())])
    assert page.desk.page == "Drive"
    assert page.desk.scenario.scenario().title == load_scenario("liashenko-i").title


def test_the_example_of_a_run_names_which_scenario_it_replaces(page: Files) -> None:
    page.tab = "runs"
    page.try_example()
    assert page.desk.notice == ""
    page.param.update(example=False, tab="line")
    choose_track(page)
    press(page, "line", "900")
    history = History(snapshot_of(page.desk))
    page.desk.param.update(page="Files")
    page.tab = "runs"
    page.try_example()
    sentence = "has replaced Line of example-limits, Metro 81-7036, 5 cars. Undo brings that back."
    assert page.desk.notice.endswith(sentence)
    history.note(snapshot_of(page.desk))
    assert history.undo()["toml"] is not None


@pytest.mark.parametrize(("former", "tab"), [("Import", "line"), ("Measured+runs", "runs")])
def test_earlier_links_open_the_page_on_their_tab(former: str, tab: str) -> None:
    read = read_link(f"?v=1&page={former}&measured_runs.coasting_only=true")
    assert read.refusal == ""
    assert read.snapshot == {"page": "Files", "files.tab": tab, "files.coasting_only": True}


def line_workbook(*more: str) -> bytes:
    """A workbook with a table of heights, one of limits and one of stations, each on a sheet of its own."""
    book = openpyxl.Workbook()
    book.active.append(["made by a test"])
    sheets = {
        "Profile": [["km", "height (m)"], [0, 120], [1, 128], [2.5, 128], [3, 121.5]],
        "Speeds": [["from (km)", "to (km)", "maxspeed"], [0, 1.5, "40 mph"], [1.5, 3, "60 mph"]],
        "Stops": [["Station", "km", "arrival", "departure"], ["A", 0, None, "23:58"], ["B", 3, "0:03", None]],
    }
    for name in (*sheets, *more):
        sheet = book.create_sheet(name)
        for row in sheets.get(name, sheets["Speeds"]):
            sheet.append(row)
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def test_one_workbook_brings_all_tables_of_a_line(page: Files) -> None:
    page.bring([("line.xlsx", line_workbook())])
    assert [(card.name, card.kind, card.failure) for card in page.cards] == [
        ("line.xlsx, Profile", "heights", ""),
        ("line.xlsx, Speeds", "limits", ""),
        ("line.xlsx, Stops", "stations", ""),
    ]
    line = page.reading.line.line
    assert line.length_m == 3000
    # 8, 0 and -13 per mille by the differences of the heights
    assert [section.gradient_permille for section in line.sections] == [8, 0, 0, -13]
    assert [(one.name, one.position_m, one.arrival_s) for one in line.stations] == [("A", 0, None), ("B", 3000, 300)]
    (offer,) = page.reading.offers
    assert (offer.time_s, offer.why) == (300, "that of the table of stations")
    press(page, "line", "300")
    assert page.desk.scenario.scenario().travel_time_s == 300
    # once more it is replaced, and its columns can be named
    page.bring([("line.xlsx", line_workbook())])
    assert len(page.cards) == 3
    stops = page.cards[-1]
    assert [choice.label for choice in stops.choices[:4]] == ["Name", "Position", "Dwell time", "Earliest arrival"]
    page.say(stops.number, "arrival", "")
    page.say(stops.number, "departure", "km")
    assert "may both be" not in page.cards[-1].failure


def test_two_sheets_of_one_kind_wait_for_a_choice(page: Files) -> None:
    page.bring([("line.xlsx", line_workbook("Speeds, down"))])
    card = {card.name: card for card in page.cards}["line.xlsx, speed limits"]
    assert "choose one sheet by its name" in card.failure
    page.say(card.number, "sheet", "Speeds, down")
    (card,) = [one for one in page.cards if one.number == card.number]
    assert (card.kind, card.failure) == ("limits", "")


def test_a_track_in_gpx_is_a_run(page: Files) -> None:
    track = Path(__file__).parents[3] / "core" / "imports" / "files" / "track.gpx"
    page.bring([(track.name, track.read_bytes())])
    assert [(card.kind, card.failure) for card in page.cards] == [("run", "")]
    page.say(page.cards[0].number, "kind", "heights")
    assert (page.cards[0].kind, page.reading.line is not None) == ("heights", True)


def test_heights_with_errors_ask_for_a_tolerance(page: Files) -> None:
    rows = "".join(f"{25 * k},{100 + 3 * (k % 2)}\n" for k in range(60))
    page.bring([("heights.csv", f"position_m,height_m\n{rows}".encode())])
    (card,) = page.cards
    assert card.failure.endswith("allow more; if not, keep it.")
    page.say(card.number, "tolerance_m", "5")
    (card,) = page.cards
    assert card.failure == ""
    # heights that go up and down by 3 m are level in the mean
    assert all(abs(section.gradient_permille) < 1 for section in page.reading.line.line.sections)
