"""The nameplate of Ftorek's motor, Table A1, beside the machine that the printed currents and copper loss imply."""

from typing import Any

import numpy as np

from railjoule.core.drive.induction.machine import (
    SteadyState,
    phase_voltage_v,
    slip_rate,
    steady_state,
    torque_constant,
)
from railjoule.core.drive.induction.traction import TractionMachines, traction_machines
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH, W_PER_KW
from railjoule.core.validation._ftorek_rows import TABLE_2
from railjoule.core.validation.ftorek_runs import paper
from railjoule.core.validation.table import Row, Table

TABLE_A1 = "Table A1"
RATED_FLUX = "At the flux that gives the printed currents, which is not printed itself."
OWN_POWER = "At the nameplate's own speed this torque would be {:.0f} kW."
TOO_LOW = "The nameplate's voltage is an amplitude of {:.0f} V a phase, too low for this flux."
AMPLITUDE = "The torque current is {:.1f} A, an amplitude: only so read, the nameplate's current gives its torque."
BY_POWER = "The nameplate's power over its speed."
NEEDED = "An amplitude of {:.0f} V a phase; {:.0f} V are assumed as the limit."


def nameplate(scenario: Scenario, plate: dict[str, Any]) -> Table:
    """Return Table A1 beside the machine that the printed currents and copper loss imply."""
    machines = traction_machines(scenario.vehicle.drive)
    machine, torque, power = machines.machine, plate["torque_nm"], plate["power_kw"] * W_PER_KW
    flux_current = machine.magnetising_current_a
    amperes = torque / (torque_constant(machine) * flux_current)
    stator_rads = 2 * np.pi * plate["frequency_hz"]
    slip_rads = slip_rate(machine) * amperes / flux_current
    state = steady_state(machine, flux_current, amperes, stator_rads - slip_rads)
    speed, case = (stator_rads - slip_rads) / machine.pole_pairs, f"{torque:g} N m at {plate['frequency_hz']:g} Hz"
    current = float(np.hypot(flux_current, amperes))
    factor = state.input_power_w / (1.5 * phase_voltage_v(state) * current)
    rows = [
        ("omega_N", "rad/s", plate["speed_rads"], speed, RATED_FLUX),
        (
            "P_N",
            "kW",
            plate["power_kw"],
            torque * speed / W_PER_KW,
            OWN_POWER.format(torque * plate["speed_rads"] / W_PER_KW),
        ),
        ("U_N", "V", plate["voltage_v"], line_voltage_v(state), TOO_LOW.format(plate["voltage_v"] * np.sqrt(2 / 3))),
        ("I_N", "A", plate["current_a"], current / np.sqrt(2), AMPLITUDE.format(amperes)),
        ("cos phi_N", "", plate["power_factor"], factor, RATED_FLUX),
    ]
    found = [Row(case, name, unit, a, float(b), note, f"{TABLE_A1}, {name}") for name, unit, a, b, note in rows]
    by_power = f"{plate['power_kw']:g} kW at {plate['speed_rads']:g} rad/s"
    found.append(Row(by_power, "Torque", "N m", torque, power / plate["speed_rads"], BY_POWER, f"{TABLE_A1}, Torque"))
    found += [_voltage_row(machines, entry, plate["voltage_v"]) for entry in paper()["table_2"]]
    return Table(
        "Nameplate of a motor, root mean squares, with the flux of the printed currents", tuple(found), TABLE_A1
    )


def line_voltage_v(state: SteadyState) -> float:
    """Compute the root mean square of the voltage between lines [V]."""
    return float(np.sqrt(1.5) * phase_voltage_v(state))


def _voltage_row(machines: TractionMachines, entry: dict[str, Any], voltage_v: float) -> Row:
    """Return the voltage that ENOC needs at the end of its start beside the nameplate's."""
    machine, speed = machines.machine, entry["max_speed_kmh"] * MS_PER_KMH * machines.turns_per_metre
    state = steady_state(machine, machine.magnetising_current_a, entry["max_current_a"], machine.pole_pairs * speed)
    case = f"{entry['max_speed_kmh']:g} km/h and {entry['max_current_a']:g} A, {TABLE_2}"
    limit = NEEDED.format(phase_voltage_v(state), machine.max_phase_voltage_v)
    return Row(case, "U", "V", voltage_v, line_voltage_v(state), limit, f"{TABLE_A1}, U_N")
