import pytest

from railjoule.core.advice import Instruction
from railjoule.dashboard.look import words


@pytest.mark.parametrize(
    ("write", "cases"),
    [
        (lambda value: words.number(value, 1), {1234567.8: "1\u202f234\u202f567.8", -3.14: "\u22123.1", -0.04: "0.0"}),
        (lambda value: words.number(value, 1), {999.96: "1\u202f000.0"}),
        (lambda value: words.number(value, 2), {0.0: "0.00"}),
        (words.signed, {0.26: "+0.3", -0.26: "\u22120.3", 0.04: "0.0", -0.04: "0.0"}),
        (words.energy, {4.9994: "4.999", 5.0: "5.00", -0.312: "\u22120.312"}),
        (words.price, {3600.0: "1.0", 359_640.0: "99.9", 360_000.0: "100"}),
        (words.energy_difference, {0.3861: "+0.386", -5.4321: "\u22125.43", 0.0: "0.000"}),
        (words.share, {0.000474: "0.05", 0.00994: "0.99", 0.00996: "1.0", 0.0581: "5.8", 0.9994: "99.9"}),
        (words.share, {0.9996: "100", 9.1708: "917", -4e-5: "0.00", float("nan"): "\u2013"}),
        (words.share_difference, {0.0581: "+5.8", -0.124: "\u221212.4", 4e-5: "0.00", -4e-5: "0.00"}),
        (words.setting, {0.5: "50", 0.505: "50.5", 0.3: "30", 1 / 3: "33.3"}),
        (words.distance, {950.0: "0.95", 2300.0: "2.30", 48_529.0: "48.53"}),
        (words.time, {5769.6: "5\u202f769.6"}),
        (words.delay, {36.46: "+36.5", -0.9: "\u22120.9", 0.04: "0.0"}),
        (words.stop_error, {-0.256: "\u22120.26"}),
        (words.speed, {10.0: "36"}),
        (words.load, {0.5: "load 50 %", 0.505: "load 50.5 %", 1.0: "load 100 %", 1.2: "crush load, 120 % of capacity"}),
        # a terminal has signs of its own
        (words.plain(words.delay), {-1234.5: "-1,234.5"}),
        (lambda value: words.plain_text(words.number(value)), {float("nan"): "-"}),
    ],
)
def test_quantities(write, cases):
    assert {value: write(value) for value in cases} == cases


@pytest.mark.parametrize(
    ("told", "text"),
    [
        (Instruction("full_power", 0, 36.9), "full power to 36.9 km/h"),
        (Instruction("full_power", 900, 63.3), "full power from 900 m to 63.3 km/h"),
        (Instruction("part_power", 55, 42.8, 125), "part power from 55 m to 42.8 km/h at 125 m"),
        (Instruction("hold", 600, 50), "hold 50 km/h from 600 m"),
        (
            Instruction("hold", 185, 46, None, (45, 47), 0.44),
            "hold 46 km/h from 185 m by turns: 44 % power to 47 km/h, coast to 45 km/h",
        ),
        (
            Instruction("hold", 1280, 45.2, None, (44.2, 46.2), 1.0),
            "hold 45.2 km/h from 1\u202f280 m by turns: full power to 46.2 km/h, coast to 44.2 km/h",
        ),
        (Instruction("coast", 43), "coast from 43 m"),
        (Instruction("coast", 0), "roll"),
        (Instruction("coast", 740, 0, 826.6), "coast from 740 m to a stop at 827 m"),
        (Instruction("brake", 4257, 61.2, 4540), "brake from 4\u202f257 m to 61.2 km/h at 4\u202f540 m"),
        (Instruction("brake", 593, 50, 600, fully=True), "brake fully from 593 m to 50 km/h at 600 m"),
        (Instruction("brake", 2196, 0, 2300, fully=True), "brake fully from 2\u202f196 m to a stop at 2\u202f300 m"),
        (Instruction("stand", 1150, stand_s=25), "stand 25 s at 1\u202f150 m"),
        (Instruction("stand", 1150, stand_s=12.5), "stand 12.5 s at 1\u202f150 m"),
    ],
)
def test_instructions_say_where_they_begin_and_what_they_aim_at(told: Instruction, text: str) -> None:
    assert words.advice_words(told) == text


def test_instructions_can_be_written_with_other_numbers() -> None:
    told = Instruction("brake", 2196, 12.5, 2300)
    assert words.advice_words(told, lambda value, digits: f"<{value:.{digits}f}>") == (
        "brake from <2196> m to <12.5> km/h at <2300> m"
    )


def test_places_that_are_named_beside_it_are_not_told_again() -> None:
    stops = (1150.0, 1950.0)
    told = [
        Instruction("full_power", 1150, 45.4),
        Instruction("brake", 1913, 0, 1950, fully=True),
        Instruction("stand", 1950, stand_s=30),
    ]
    texts = [words.advice_words(one, named=stops) for one in told]
    assert texts == ["full power to 45.4 km/h", "brake fully from 1\u202f913 m to a stop", "stand 30 s"]


def test_more_of_the_same_begins_where_it_ended() -> None:
    advice = [
        Instruction("part_power", 0, 17.8, 15),
        Instruction("part_power", 15, 31.3, 55),
        Instruction("hold", 55, 31.3),
        Instruction("part_power", 80, 40, 120),
    ]
    assert list(words.advice_in_words(advice)) == [
        "part power to 17.8 km/h at 15 m",
        "part power to 31.3 km/h at 55 m",
        "hold 31.3 km/h from 55 m",
        "part power from 80 m to 40 km/h at 120 m",
    ]


def test_a_continuous_curve_is_one_instruction() -> None:
    advice = [
        Instruction("full_power", 0, 20),
        *(Instruction("part_power", 10 * k, 20 + 5 * k, 10 * k + 10) for k in (1, 2, 3)),
        Instruction("hold", 40, 35),
        Instruction("part_power", 200, 33, 300),
        *(Instruction("brake", 300 + 20 * k, 22 - 11 * k, 320 + 20 * k, fully=k == 2) for k in (0, 1, 2)),
    ]
    assert words.instruction_groups(advice) == [(0,), (1, 2, 3), (4,), (5,), (6, 7, 8)]
    assert list(words.advice_in_words(advice)) == [
        "full power to 20 km/h",
        "part power gradually from 10 m to 35 km/h at 40 m",
        "hold 35 km/h from 40 m",
        "ease off from 35 to 33 km/h between 200 m and 300 m",
        "brake gradually from 300 m to a stop at 360 m",
    ]


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        ("changing at 1150 m.", "changing at 1\u202f150 m."),
        ("travel_time_s = 1080.0 s is below 12000 s", "travel_time_s = 1\u202f080.0 s is below 12\u202f000 s"),
        # years, names and decimals are no quantities
        ("Liashenko 2025 prints 0.0001 kWh for profile-1300 m", "Liashenko 2025 prints 0.0001 kWh for profile-1300 m"),
        ("950 m", "950 m"),
    ],
)
def test_quantities_in_sentences_have_narrow_spaces(sentence: str, shown: str) -> None:
    assert words.grouped(sentence) == shown


def test_a_note_of_all_runs_comes_once():
    common = "The time follows from a reserve."
    notes = {"Four phases": [common, "It has 13 cycles."], "Optimal": (common,)}
    assert words.notes_by_run(notes) == [common, "Four phases: It has 13 cycles."]
    assert words.notes_by_run({"Optimal": [common]}) == [f"Optimal: {common}"]
