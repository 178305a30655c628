import pytest

from railjoule.core.phases import Phase
from railjoule.dashboard.look import words


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1234567.8, 1, "1\u202f234\u202f567.8"),
        (-3.14, 1, "\u22123.1"),
        (-0.04, 1, "0.0"),
        (0.0, 2, "0.00"),
        (999.96, 1, "1\u202f000.0"),
    ],
)
def test_numbers(value: float, digits: int, text: str) -> None:
    assert words.number(value, digits) == text


@pytest.mark.parametrize(("value", "text"), [(0.26, "+0.3"), (-0.26, "\u22120.3"), (0.04, "0.0"), (-0.04, "0.0")])
def test_differences_bear_a_sign_unless_they_read_as_zero(value: float, text: str) -> None:
    assert words.signed(value) == text


@pytest.mark.parametrize(("kwh", "text"), [(4.9994, "4.999"), (5.0, "5.00"), (-0.312, "\u22120.312")])
def test_energies_have_three_decimals_below_five(kwh: float, text: str) -> None:
    assert words.energy(kwh) == text


@pytest.mark.parametrize(("watt", "text"), [(3600.0, "1.0"), (359_640.0, "99.9"), (360_000.0, "100")])
def test_prices_are_in_wh_per_s(watt: float, text: str) -> None:
    assert words.price(watt) == text


@pytest.mark.parametrize(("kwh", "text"), [(0.3861, "+0.386"), (-5.4321, "\u22125.43"), (0.0, "0.000")])
def test_differences_of_energies_have_their_decimals_and_a_sign(kwh: float, text: str) -> None:
    assert words.energy_difference(kwh) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.000474, "0.05"),
        (0.00994, "0.99"),
        (0.00996, "1.0"),
        (0.0581, "5.8"),
        (0.9994, "99.9"),
        (0.9996, "100"),
        (9.1708, "917"),
        (-4e-5, "0.00"),
        (float("nan"), "\u2013"),
    ],
)
def test_shares_are_in_percent_with_more_decimals_the_smaller_they_are(share: float, text: str) -> None:
    assert words.share(share) == text


@pytest.mark.parametrize(("share", "text"), [(0.0581, "+5.8"), (-0.124, "\u221212.4"), (4e-5, "0.00"), (-4e-5, "0.00")])
def test_relative_differences_have_a_sign_unless_they_read_as_zero(share: float, text: str) -> None:
    assert words.share_difference(share) == text


@pytest.mark.parametrize(("factor", "text"), [(0.5, "50"), (0.505, "50.5"), (0.3, "30"), (1 / 3, "33.3")])
def test_settings_are_whole_unless_set_finer(factor: float, text: str) -> None:
    assert words.setting(factor) == text


@pytest.mark.parametrize(("metres", "text"), [(950.0, "0.95"), (2300.0, "2.30"), (48_529.0, "48.53")])
def test_lengths_are_in_km(metres: float, text: str) -> None:
    assert words.distance(metres) == text


def test_times_delays_and_stopping_errors() -> None:
    assert words.time(5769.6) == "5\u202f769.6"
    assert (words.delay(36.46), words.delay(-0.9), words.delay(0.04)) == ("+36.5", "\u22120.9", "0.0")
    assert words.stop_error(-0.256) == "\u22120.26"


def test_a_terminal_has_signs_of_its_own() -> None:
    assert words.plain(words.delay)(-1234.5) == "-1,234.5"
    assert words.plain_text(words.number(float("nan"))) == "-"


def test_speeds_are_in_km_per_h() -> None:
    assert words.speed(10.0) == "36"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("full_power", "full power to 36 km/h"),
        ("part_power", "part power to 36 km/h"),
        ("hold", "hold 36 km/h"),
        ("coast", "coast"),
        ("brake", "brake"),
        ("stand", "stand 20 s"),
    ],
)
def test_phases_as_advice(name: str, text: str) -> None:
    phase = Phase(name, 0.0, 100.0, 5.0, 25.0, 0.0, 10.0, 1e6)  # type: ignore[arg-type]
    assert words.phase_words(phase) == text


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (0.5, "load 50 %"),
        (0.505, "load 50.5 %"),
        (1.0, "load 100 %"),
        (1.2, "crush load, 120 % of capacity"),
    ],
)
def test_a_load_above_the_capacity_is_a_crush_load(factor: float, text: str) -> None:
    assert words.load(factor) == text
