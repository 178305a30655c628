"""The current that a vehicle takes from its line, and the power of a measured one."""

from railjoule.core.arrays import FloatArray, frozen_array


def supply_current_a(supply_power_w: FloatArray, line_voltage_v: float | None) -> FloatArray | None:
    """Return the current at the line, power over voltage; None where the voltage is not known.

    Parameters
    ----------
    supply_power_w : array of shape (n,)
        Power taken from the line, auxiliaries included; negative where energy goes back [W].
    line_voltage_v : float or None
        Voltage at the vehicle, taken as constant [V]. On an alternating voltage this is the active part of the current.

    Returns
    -------
    array of shape (n,) or None
        Negative where energy goes back [A].
    """
    return None if line_voltage_v is None else frozen_array(supply_power_w / line_voltage_v)


def power_of_supply_current_w(current_a: FloatArray, line_voltage_v: FloatArray | float) -> FloatArray:
    """Return the power taken from the line, current times voltage [W]; negative where energy goes back.

    Parameters
    ----------
    current_a : array of shape (n,)
        Current at the line, negative where energy goes back [A]; on an alternating voltage its active part.
    line_voltage_v : array of shape (n,) or float
        Voltage at the vehicle [V].
    """
    return frozen_array(current_a * line_voltage_v)
