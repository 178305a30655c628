import numpy as np
import pytest
from builders import COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

from railjoule.core import load_scenario
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.actual_vehicle import actual_vehicle, notes_on, voltage_notes
from railjoule.core.simulation.following import simulate_following
from railjoule.core.studies.montecarlo import monte_carlo


def meshes(**disturbance):
    scenario = load_scenario("liashenko-i").replace(**{f"disturbance.{key}": it for key, it in disturbance.items()})
    return build_meshed_line(scenario).data, build_meshed_line(actual_vehicle(scenario)).data


def test_nothing_disturbed_nothing_changed():
    scenario = load_scenario("liashenko-i")
    assert actual_vehicle(scenario) == scenario


def test_resistance_changes_by_its_factor_alone():
    plan, real = meshes(resistance_factor=1.3)
    assert real.resistance_constant_n == pytest.approx(1.3 * plan.resistance_constant_n)
    assert real.resistance_quadratic == pytest.approx(1.3 * plan.resistance_quadratic)
    assert np.array_equal(real.line_force_n, plan.line_force_n)


def test_a_lower_voltage_takes_power_and_leaves_the_effort_at_low_speed():
    plan, real = meshes(line_voltage_factor=0.8)
    assert real.traction.effort_n(1.0) == plan.traction.effort_n(1.0)
    assert real.traction.effort_n(20.0) == pytest.approx(0.8 * plan.traction.effort_n(20.0))


def test_a_curve_of_effort_is_pressed_together_along_the_speed():
    curve = [[0.0, 200.0], [30.0, 200.0], [60.0, 100.0], [80.0, 60.0]]
    scenario = load_scenario("liashenko-i").replace(
        **{"vehicle.traction.curve": curve, "disturbance.line_voltage_factor": 0.5}
    )
    assert actual_vehicle(scenario).vehicle.traction.curve == ((0.0, 200.0), (15.0, 200.0), (30.0, 100.0), (40.0, 60.0))


def test_the_electric_brakes_curve_and_the_breakdown_move_with_the_voltage():
    """Beyond the breakdown the effort goes with the square of the voltage: a quarter at half of it."""
    changes = {
        "vehicle.braking": {"curve": [[0, 100], [40, 100], [80, 50]], "breakdown_speed_kmh": 60},
        "disturbance.line_voltage_factor": 0.5,
    }
    scenario = load_scenario("liashenko-i").replace(**changes)
    braking = actual_vehicle(scenario).vehicle.braking
    assert (braking.curve, braking.breakdown_speed_kmh) == (((0.0, 100.0), (20.0, 100.0), (40.0, 50.0)), 30.0)
    plan, real = build_meshed_line(scenario).data, build_meshed_line(actual_vehicle(scenario)).data
    assert real.braking.effort_n(20.0) == pytest.approx(plan.braking.effort_n(20.0) / 4, rel=1e-5)
    assert not any("electric braking" in note for note in voltage_notes(scenario.vehicle))


def test_head_wind_costs_energy_and_less_voltage_costs_time():
    scenario = load_scenario("liashenko-ii")
    assert simulate_following(scenario.replace(**{"disturbance.resistance_factor": 1.2})).overconsumption > 0.005
    tight = scenario.replace(**{"timetable.travel_time_s": 100.0, "disturbance.line_voltage_factor": 0.5})
    assert simulate_following(tight).delay_s > 0.5
    late = simulate_following(scenario.replace(**{"disturbance.departure_delay_s": 12.0}))
    assert (late.delay_s, late.overconsumption) == (pytest.approx(12.0, abs=1e-6), pytest.approx(0, abs=1e-9))


def test_kinds_of_cars_and_a_synchronous_drive_are_disturbed_as_well():
    kinds = [{"cars": 3, "constant_n_per_kn": 1.2}, {"cars": 2, "constant_n_per_kn": 0.8}]
    scenario = load_scenario("kharkiv-like-40kmh").replace(
        **{
            "vehicle.resistance.car_kinds": kinds,
            "disturbance.resistance_factor": 1.5,
            "disturbance.line_voltage_factor": 0.9,
        }
    )
    real = actual_vehicle(scenario).vehicle
    assert real.drive.link_voltage_v == pytest.approx(0.9 * scenario.vehicle.drive.link_voltage_v)
    wanted = 1.5 * scenario.vehicle.specific_resistance.constant_n_per_kn
    assert real.specific_resistance.constant_n_per_kn == pytest.approx(wanted)


VOLTAGE = {"disturbance.line_voltage_factor": 0.8}
DRIVES = {
    "constant_efficiency": {"model": "constant_efficiency", "traction_efficiency": 0.85},
    "copper_loss": COPPER_LOSS,
    "loss_polynomial": LOSS_POLYNOMIAL,
    "induction": INDUCTION,
}


@pytest.mark.parametrize("model", DRIVES)
def test_a_note_says_what_another_voltage_leaves_as_it_is(model):
    limits = {"vehicle.traction.max_power_kw": None, "vehicle.braking.max_power_kw": 900.0}
    notes = notes_on(plain_scenario({"vehicle.drive": DRIVES[model], **limits, **VOLTAGE}))
    if model == "induction":
        assert notes == ()
        return
    (note,) = notes
    assert note == (
        "This train's data give no line voltage and no power or curve of effort to scale with it: the tractive effort "
        "stays as at nominal voltage."
    )


def test_there_is_no_note_where_nothing_is_left_out():
    both = {"vehicle.traction.max_power_kw": 900.0, "vehicle.braking.max_power_kw": 900.0}
    assert notes_on(plain_scenario({**both, **VOLTAGE})) == ()
    assert notes_on(plain_scenario({"vehicle.traction.max_power_kw": None})) == ()


def test_the_run_and_the_draw_bear_the_note():
    scenario = load_scenario("liashenko-ii").replace(**{"vehicle.traction.max_power_kw": None, **VOLTAGE})
    notes = voltage_notes(scenario.vehicle)
    assert simulate_following(scenario).actual.notes == notes
    assert monte_carlo(scenario.replace(**{"montecarlo.runs": 1})).notes == notes
    assert len(notes) == 1


def test_each_kind_of_drive_has_its_own_voltage():
    induction = plain_scenario({"vehicle.drive": INDUCTION}).vehicle.drive
    assert induction.at_voltage(0.8).max_phase_voltage_v == pytest.approx(0.8 * induction.max_phase_voltage_v)
    plain = plain_scenario().vehicle.drive
    assert plain.at_voltage(0.8) is plain
    machine = load_scenario("ftorek-300s").vehicle.drive
    if machine.machine is not None:
        lowered = machine.at_voltage(0.5).machine.max_phase_voltage_v
        assert lowered == pytest.approx(0.5 * machine.machine.max_phase_voltage_v)
    assert (induction.has_voltage_limit, plain.has_voltage_limit, machine.has_voltage_limit) == (True, False, False)


def test_at_a_lower_voltage_power_falls_up_to_the_top_speed():
    """Where the curve ends below it, too (review A4: there the voltage changed nothing)."""
    changes = {
        "vehicle.traction.curve": [[0, 200], [40, 200], [60, 100]],
        "vehicle.traction.max_power_kw": None,
        **VOLTAGE,
    }
    scenario = plain_scenario(changes)
    full, less = build_meshed_line(scenario).data.traction, build_meshed_line(actual_vehicle(scenario)).data.traction
    fast = np.array([65.0, 80.0, 95.0]) / 3.6
    assert less.effort_n(fast) == pytest.approx(0.8 * full.effort_n(fast), rel=1e-5)
