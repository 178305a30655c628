"""The current that a vehicle takes from its line."""

from railjoule.core.arrays import FloatArray, frozen_array


def line_current_a(line_power_w: FloatArray, line_voltage_v: float | None) -> FloatArray | None:
    """Return the current at the line, power over voltage; None where the voltage is not known.

    Parameters
    ----------
    line_power_w : array of shape (n,)
        Power taken from the line, auxiliaries included; negative where energy goes back [W].
    line_voltage_v : float or None
        Voltage at the vehicle, taken as constant [V]. On an alternating voltage this is the active part of the current.

    Returns
    -------
    array of shape (n,) or None
        Negative where energy goes back [A].
    """
    return None if line_voltage_v is None else frozen_array(line_power_w / line_voltage_v)
