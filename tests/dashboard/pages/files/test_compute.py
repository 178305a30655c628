"""What files give together, and the scenarios that are made of it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from railjoule.core import Scenario, load_scenario
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.pages.files.brought import Brought
from railjoule.dashboard.pages.files.cards import build_card
from railjoule.dashboard.pages.files.compute import (
    Reading,
    Request,
    Stretch,
    read_files,
    taken,
)
from railjoule.dashboard.pages.files.page import EXAMPLE_LINE, sources

FILES = Path(__file__).parents[3] / "core" / "imports" / "files"


@pytest.fixture(scope="module")
def base() -> Scenario:
    return load_scenario("metro-with-limit")


def example(stretch: Stretch | None = None) -> tuple[tuple[Brought, ...], Stretch]:
    """The shipped example with its first track."""
    brought = tuple(Brought(number, one.name, one.content) for number, one in enumerate(sources(EXAMPLE_LINE), 1))
    chosen = tuple(file.with_choice("rows NOM_VOIE", "V1") if file.kind == "gradients" else file for file in brought)
    return chosen, stretch or Stretch()


def read(base: Scenario, files: tuple[Brought, ...], stretch: Stretch | None = None) -> Reading:
    *_, last = read_files(Request(files, stretch or Stretch(), base))
    return last


def brought(*names: str) -> tuple[Brought, ...]:
    return tuple(Brought(number, name, (FILES / name).read_bytes()) for number, name in enumerate(names, 1))


def test_the_example_asks_for_its_track() -> None:
    cards = [build_card(Brought(1, one.name, one.content)) for one in sources(EXAMPLE_LINE)]
    assert [card.kind for card in cards] == ["limits", "gradients", "curves"]
    failures = [card.failure for card in cards]
    assert failures == ["", "example-gradients.csv: its rows are of several NOM_VOIE: V1, V2; choose one.", ""]
    menu = next(choice for choice in cards[1].choices if choice.key == "rows NOM_VOIE")
    assert menu.options == (("", "choose"), ("V1", "V1"), ("V2", "V2"))


def test_the_example_becomes_a_scenario_with_the_vehicle_that_is_there(base: Scenario) -> None:
    files, _ = example()
    reading = read(base, files)
    # from 12+000 to 24+000 of the three tables
    assert reading.line.line.length_m == 12_000
    assert reading.offers is not None
    (offer,) = reading.offers
    assert offer.what == "line"
    assert offer.shortest_s < offer.time_s <= 1.1 * offer.shortest_s + 1
    scenario = parse_scenario(taken(offer, offer.time_s), "test")
    assert scenario.vehicle == base.vehicle
    assert scenario.line == reading.line.line
    assert scenario.travel_time_s == offer.time_s


def test_a_part_of_the_line_in_falling_chainage(base: Scenario) -> None:
    files, _ = example()
    reading = read(base, files, Stretch("12.7km", "15+100", reverse=True))
    gradients = [(one.length_m, one.gradient_permille) for one in reading.line.line.sections]
    # the rows -4 from 14+300 and 6.5 from 12+700, from the other side; the limit changes at 13+200, a curve at 14+900
    assert gradients == [(200, 4), (600, 4), (1100, -6.5), (500, -6.5)]


def test_a_place_that_is_none_is_refused(base: Scenario) -> None:
    files, _ = example()
    reading = read(base, files, Stretch("here"))
    assert reading.line is None
    assert reading.failure.startswith("From: 'here' ")


def test_a_line_can_be_given_a_name(base: Scenario) -> None:
    files, _ = example()
    for brought_files in (files, brought("ttobench-track.json")):
        (offer,) = read(base, brought_files, Stretch(name="Harbour line")).offers or ()
        scenario = parse_scenario(taken(offer, offer.time_s), "test")
        assert (scenario.line.name, scenario.title) == ("Harbour line", "Harbour line, Metro 81-7036, 5 cars")


def test_ttobench_gives_line_train_and_time(base: Scenario) -> None:
    reading = read(base, brought("ttobench-track.json", "ttobench-train.json", "ttobench-journey.json"))
    offers = {offer.what: offer for offer in reading.offers or ()}
    assert list(offers) == ["both", "line", "train"]
    # of the journey
    assert (offers["both"].time_s, offers["both"].why) == (360.0, "the journey\u2019s")
    both = parse_scenario(taken(offers["both"], 360.0), "test")
    assert both.title == "Example_Track, Example_Train"
    # the tunnel changes the train's resistance only where both are there
    assert [one.tunnel_factor for one in both.line.sections if one.tunnel_factor != 1] == [2.0]
    assert parse_scenario(taken(offers["train"], 300.0), "test").line == base.line


def test_a_journey_alone_says_what_it_needs(base: Scenario) -> None:
    reading = read(base, brought("ttobench-journey.json"))
    assert reading.failure == "ttobench-journey.json: it needs its track and its train; add both."
    assert reading.offers == ()


def test_a_unit_in_doubt_is_asked_and_answered(base: Scenario) -> None:
    document = json.loads((FILES / "ttobench-train.json").read_text())
    document["max traction force"] = {"unit": "N", "value": 190}
    file = Brought(1, "train.json", json.dumps(document).encode())
    (question,) = build_card(file).questions
    assert question.sentence == "vehicle.traction.max_effort_kn = 0.19 kN for a train of 160 t: was 190 kN meant?"
    assert [word for word, _ in question.answers] == ["Use 190 kN", "Keep 0.19 kN"]
    use, keep = (value for _, value in question.answers)
    used = build_card(file.with_choice(question.key, use))
    assert used.questions == ()
    assert used.result.vehicle.traction.max_effort_kn == 190
    kept = build_card(file.with_choice(question.key, keep))
    assert kept.questions == ()
    assert kept.result.vehicle.traction.max_effort_kn == 0.19


def test_positions_in_doubt_are_asked_and_answered() -> None:
    file = Brought(1, "g.csv", b"from,to,gradient_permille\n0,1.5,2\n1.5,4,-3\n")
    (question,) = build_card(file).questions
    assert (question.sentence, question.answers) == ("Positions in km or in m?", (("Use km", "km"), ("Keep m", "m")))
    assert build_card(file.with_choice(question.key, "km")).result.end_m == 4000
    assert build_card(file.with_choice(question.key, "m")).questions == ()


def test_of_two_files_of_a_kind_the_last_counts_and_it_is_told(base: Scenario) -> None:
    reading = read(base, brought("limits.csv", "sncf-limits.csv"))
    assert reading.unused[0] == "limits.csv: sncf-limits.csv is taken for it."
    assert [table.source for table in reading.tables] == ["sncf-limits.csv"]


TWO_FAULTS = b"""PKD;PKF;VALEUR;TYPE;NOM_VOIE
012+000;014+000;2.5;rampe;V1
014+000;024+000;abc;rampe;V1
012+000;024+000;4;pente;V2
"""


def offers_with(base: Scenario, gradients: Brought) -> dict[str, tuple[str, ...]]:
    """Return what each offer waits for where the example's limits come with a table of gradients."""
    limits = next(Brought(1, one.name, one.content) for one in sources(EXAMPLE_LINE) if "limits" in one.name)
    return {offer.what: offer.waits_for for offer in read(base, (limits, gradients)).offers or ()}


def test_a_line_waits_for_a_file_that_cannot_be_read(base: Scenario) -> None:
    """Both faults of one file: rows of two tracks, and behind that choice a cell that is no number."""
    file = Brought(2, "gradients.csv", TWO_FAULTS)
    assert build_card(file).failure == "gradients.csv: its rows are of several NOM_VOIE: V1, V2; choose one."
    assert offers_with(base, file) == {"line": ("the gradients",)}
    file = file.with_choice("rows NOM_VOIE", "V1")
    assert build_card(file).failure == "gradients.csv, row 3: VALEUR = 'abc' must be a number."
    assert offers_with(base, file) == {"line": ("the gradients",)}
    assert offers_with(base, file.with_choice("rows NOM_VOIE", "V2")) == {"line": ()}


def test_a_file_of_an_unknown_kind_is_waited_for_too(base: Scenario) -> None:
    assert offers_with(base, Brought(2, "staff.csv", b"name,role\nA,1\n")) == {"line": ("staff.csv",)}


def test_a_train_does_not_wait_for_gradients(base: Scenario) -> None:
    train = replace(brought("ttobench-train.json")[0], number=3)
    limits = next(Brought(1, one.name, one.content) for one in sources(EXAMPLE_LINE) if "limits" in one.name)
    reading = read(base, (limits, Brought(2, "gradients.csv", TWO_FAULTS), train))
    waits = {offer.what: offer.waits_for for offer in reading.offers or ()}
    assert waits == {"both": ("the gradients",), "line": ("the gradients",), "train": ()}


def test_a_unit_that_is_not_understood_is_chosen_on_the_card() -> None:
    file = Brought(1, "g.csv", b"from_m,to_m,gradient (x)\n0,500,1.2\n")
    card = build_card(file)
    assert card.failure == "g.csv: 'gradient (x)' contains 'x', which is not understood; choose the unit."
    choice = next(choice for choice in card.choices if choice.key == "value_unit")
    assert (choice.value, choice.options[:3]) == (
        "",
        (("", "choose"), ("permille", "per mille"), ("percent", "per cent")),
    )
    assert card.questions == ()
    answered = build_card(file.with_choice("value_unit", "percent"))
    assert (answered.failure, answered.result.intervals[0].value) == ("", 12)
    assert build_card(file.with_choice("value_unit", "percent").with_choice("value_unit", "")).failure == card.failure


def test_a_code_page_is_chosen_on_the_card() -> None:
    file = Brought(1, "gradients.csv", "Початок, км;Кінець, км;Ухил, \u2030\n0;0,5;3,5\n".encode("cp1251"))
    card = build_card(file)
    assert (card.failure, card.kind, card.choices[0].label, card.choices[0].value) == (
        "",
        "gradients",
        "Text in",
        "cp1251",
    )
    assert card.findings == ("Not UTF-8, and so read as Windows-1251.",)
    assert build_card(file.with_choice("encoding", "cp1252")).failure.startswith("gradients.csv: no column has the")
    # Polish in Latin-2 is in no code page that is looked for
    polish = "od;do;pochylenie \u015brednie (\u2030)\n0;500;3\n".replace("\u2030", "o/oo").encode("iso8859_2")
    file = Brought(1, "gradients.csv", polish)
    card = build_card(file)
    assert card.failure == (
        "gradients.csv: not UTF-8, and none of Windows-1250, -1251, -1252 and GBK is possible; save it as UTF-8, or "
        "name its code page."
    )
    assert [choice.key for choice in card.choices] == ["encoding"]
    assert build_card(file.with_choice("encoding", "iso8859_2")).cells.header[2] == "pochylenie \u015brednie (o/oo)"
