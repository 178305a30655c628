"""What is shipped: every file is valid, says where its numbers come from, and gives known values at known points."""

import re

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.motion.meshed_line import build_meshed_line
from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import Line, Vehicle, load_scenario, preset_document, preset_names, preset_text

SHIPPED = [(kind, name) for kind in ("vehicles", "lines", "scenarios") for name in preset_names(kind)]


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_every_file_is_valid(kind, name):
    if kind == "scenarios":
        assert load_scenario(name).line.length_m > 0
    else:
        assert {"vehicles": Vehicle, "lines": Line}[kind].model_validate(preset_document(kind, name)).name


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_every_file_begins_with_what_it_is_and_where_it_comes_from(kind, name):
    head = "".join(line for line in preset_text(kind, name).splitlines()[:3] if line.startswith("#"))
    assert re.search(r"Source: .+ 20\d\d|showcase", head)


@pytest.mark.parametrize("name", preset_names("vehicles"))
def test_every_number_of_a_vehicle_says_its_source(name):
    """In its own line, in the line before, or in the heading of its table."""
    heading, before = "", ""
    for line in preset_text("vehicles", name).splitlines():
        if line.startswith("["):
            heading = line
        if re.match(r"\w+ = [-\d.]", line):
            assert "#" in line + heading or before.startswith("#"), line
        before = line


def test_a_preset_is_a_fresh_copy():
    first = preset_document("lines", "flat-5km")
    first["sections"][0]["length_m"] = 1
    assert preset_document("lines", "flat-5km")["sections"][0]["length_m"] == 5000


def test_an_unknown_preset():
    with pytest.raises(
        ScenarioError,
        match=r"^there is no preset 'flat-6km' among the lines, did you mean 'flat-5km' or 'flat-950m'\?$",
    ):
        preset_document("lines", "flat-6km")


@pytest.mark.parametrize(
    ("name", "length_m", "climb_m"),
    [
        # sums of Tables 1 to 3 and the text below (11) of Liashenko 2025, done by hand
        ("liashenko-0", 1000, 3.0),
        ("liashenko-i", 1000, 3.95),
        ("liashenko-ii", 1300, -2.7),
        ("liashenko-iii", 1700, 31.4),
    ],
)
def test_length_and_climb_of_liashenkos_profiles(name, length_m, climb_m):
    sections = load_scenario(name).line.sections
    assert sum(section.length_m for section in sections) == length_m
    assert sum(section.length_m * section.gradient_permille for section in sections) / 1000 == pytest.approx(climb_m)


def test_load_torque_of_ftoreks_train():
    """A = 169.90 N m, B = 0.60170, C = 0.0040163 at the motor's shaft: findings on Ftorek 2025, (5)."""
    constant, linear, quadratic = resistance_coefficients(load_scenario("ftorek-300s").vehicle)
    turns_per_metre = 3.73 / 0.455
    assert constant / turns_per_metre == pytest.approx(169.90, rel=1e-4)
    assert linear / turns_per_metre**2 == pytest.approx(0.60170, rel=1e-4)
    assert quadratic / turns_per_metre**3 == pytest.approx(0.0040163, rel=1e-4)


def test_metro_at_half_load():
    """1.1 + 0.00084 V^2 N/kN and 1.2 m/s2 at half load, as the comments of the file say."""
    scenario = load_scenario("liashenko-ii")
    vehicle = scenario.vehicle
    weight_kn = vehicle.total_mass_kg * 9.81 / 1e3
    assert weight_kn == pytest.approx(2078.9, rel=1e-4)
    constant, _, quadratic = resistance_coefficients(vehicle)
    assert constant / weight_kn == pytest.approx(1.1)
    assert quadratic / 3.6**2 / weight_kn == pytest.approx(0.00084, rel=1e-4)
    mesh = build_meshed_line(scenario)
    assert mesh.data.traction.constant_n / vehicle.total_inertia_kg == pytest.approx(1.2, rel=1e-2)
