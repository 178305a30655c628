"""The electric power of a recording that has a line current instead: current times voltage."""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.line_current import power_of_line_current_w
from railjoule.core.measured.recording import Recording

UNIT_FACTOR = 3.0
"""Beyond this many times the vehicle's voltage, or a part of it as small, a measured one is in another unit."""
SIGN = "regenerated current counts as negative"
NO_SIGN = "the current is never negative: nothing went back, or the recorder leaves out its sign"


def with_line_power(recording: Recording, line_voltage_v: float | None) -> Recording:
    """Return a recording whose line current has become its electric power, and a sentence that says so.

    A measured power and an energy meter go before it; the current is then not used, and that is told.

    Parameters
    ----------
    recording : Recording
        What the recorder wrote.
    line_voltage_v : float or None
        That of the vehicle, where the file has no voltage [V].

    Raises
    ------
    RecordingError
        If the measured voltage is none of a line of this voltage.
    """
    current, voltage = recording.line_current_a, recording.line_voltage_v
    if current is None:
        return recording
    without = replace(recording, line_current_a=None, line_voltage_v=None)
    if recording.power_w is not None or recording.energy_j is not None:
        what = "power" if recording.power_w is not None else "energy meter"
        return _told(without, f"The line current is not used: the file has the {what}.")
    if voltage is None and line_voltage_v is None:
        return _told(
            without,
            "The line current gives no power: the file has no line voltage, and the vehicle no line_voltage_v.",
        )
    if voltage is not None:
        _require_unit(recording.name, voltage, line_voltage_v)
    by = "the line voltage" if voltage is not None else f"the vehicle's line_voltage_v of {line_voltage_v:g} V"
    sentence = f"The electric power is the line current times {by}; {sign_words(current)}."
    return _told(replace(without, power_w=power_of_line_current_w(current, _known(voltage, line_voltage_v))), sentence)


def sign_words(current_a: FloatArray) -> str:
    """Return how the sign of a line current counts, or that it has none, as the end of a sentence."""
    return SIGN if float(np.nanmin(current_a, initial=0.0)) < 0 else NO_SIGN


def _known(voltage_v: FloatArray | None, of_vehicle_v: float | None) -> FloatArray | float:
    if voltage_v is not None:
        return voltage_v
    assert of_vehicle_v is not None
    return of_vehicle_v


def _require_unit(name: str, voltage_v: FloatArray, of_vehicle_v: float | None) -> None:
    """Refuse a voltage that a vehicle for another one cannot have."""
    known = voltage_v[voltage_v > 0]
    if of_vehicle_v is None or not len(known):
        return
    usual = float(np.median(known))
    if not of_vehicle_v / UNIT_FACTOR <= usual <= UNIT_FACTOR * of_vehicle_v:
        raise RecordingError(
            f"{name}: the line voltage is about {usual:.5g} V, but the vehicle's line_voltage_v is {of_vehicle_v:g} V; "
            "is it in another unit (--unit line_voltage=...), or another vehicle?"
        )


def _told(recording: Recording, sentence: str) -> Recording:
    return replace(recording, notes=(*recording.notes, sentence))
