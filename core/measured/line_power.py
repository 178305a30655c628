"""The electric power of a recording that has a line current instead: current times voltage."""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import power_of_supply_current_w
from railjoule.core.errors import RecordingError
from railjoule.core.measured.recording import Recording

UNIT_FACTOR = 3.0
"""A voltage or an effort beyond this many times that of the vehicle is in another unit, as is a part as small."""


def with_supply_power(recording: Recording, line_voltage_v: float | None) -> Recording:
    """Compute the electric power of a recording from its line current, with a note.

    A measured power and an energy meter precede it; the current is then not used.

    Parameters
    ----------
    recording : Recording
        The recording.
    line_voltage_v : float or None
        Voltage of the vehicle's line, for a file without a voltage [V].

    Raises
    ------
    RecordingError
        If the measured voltage is none of a line of this voltage.
    """
    current, voltage, power = recording.supply_current_a, recording.line_voltage_v, recording.power_w
    if current is None:
        return recording
    if power is not None or recording.energy_j is not None:
        note = f"The line current is not used: the file has the {'energy meter' if power is None else 'power'}."
    elif voltage is not None:
        _require_unit(recording.name, voltage, line_voltage_v)
        power = power_of_supply_current_w(current, voltage)
        note = f"The electric power is the line current times the line voltage; {sign_words(current)}."
    elif line_voltage_v is not None:
        power = power_of_supply_current_w(current, line_voltage_v)
        by = f"the vehicle's line_voltage_v of {line_voltage_v:g} V"
        note = f"The electric power is the line current times {by}; {sign_words(current)}."
    else:
        note = "The line current gives no power: the file has no line voltage, and the vehicle no line_voltage_v."
    return replace(recording, power_w=power, supply_current_a=None, line_voltage_v=None, notes=(*recording.notes, note))


def sign_words(current_a: FloatArray) -> str:
    """Return how the sign of a line current counts, or that it has none, as the end of a sentence."""
    if float(np.nanmin(current_a, initial=0.0)) < 0:
        return "regenerated current counts as negative"
    return "the current is never negative: nothing went back, or the recorder leaves out its sign"


def _require_unit(name: str, voltage_v: FloatArray, of_vehicle_v: float | None) -> None:
    """Refuse a voltage that a vehicle for another one cannot have."""
    usual = float(np.median(voltage_v[voltage_v > 0])) if np.any(voltage_v > 0) else of_vehicle_v
    if of_vehicle_v and usual and not of_vehicle_v / UNIT_FACTOR <= usual <= UNIT_FACTOR * of_vehicle_v:
        raise RecordingError(
            f"{name}: the line voltage is about {usual:.5g} V, but the vehicle's line_voltage_v is {of_vehicle_v:g} V; "
            "is it in another unit (--unit line_voltage=...), or another vehicle?"
        )
