"""Rows of Ftorek's tables: one printed entry and quantity beside ours."""

from typing import Any

from railjoule.core.units import STANDARD_GRAVITY_MS2
from railjoule.core.validation.table import Row

Printed = dict[str, Any]

TABLE_1, TABLE_2 = "Table 1", "Table 2"
FOLLOWS = "It includes W_sh, and with it the same difference."
# the symbols and units of Tables 1 and 2, by the keys of assets/papers/ftorek-2025.toml
QUANTITIES = {
    "acceleration_time_s": ("T_e", "s"),
    "max_speed_kmh": ("v_max", "km/h"),
    "max_current_a": ("I_max", "A"),
    "min_current_a": ("I_min", "A"),
    "shaft_energy_wh": ("W_sh", "Wh"),
    "peak_energy_wh": ("W_max", "Wh"),
    "total_energy_wh": ("W_T", "Wh"),
}


def as_if_heavier(entry: Printed, ours: float) -> str:
    """Return in one sentence by how much a shaft energy of ours [Wh] is off, and which gravity would explain it.

    On a level line it is the work of the running resistance, nearly in proportion to the weight.
    """
    ratio = entry["shaft_energy_wh"] / ours
    gravity = STANDARD_GRAVITY_MS2 * ratio
    return f"{100 * (1 / ratio - 1):+.2f} %, as if the paper took g = {gravity:.3f} m/s2 for the weight."


def printed_row(place: str, entry: Printed, key: str, ours: float, note: str = "", by: str = "") -> Row:
    """Return the row of an entry's quantity.

    Parameters
    ----------
    place : str
        Table of the paper that prints the entry; empty if it is not printed.
    entry : dict
        One run of `assets/papers/ftorek-2025.toml`.
    key : str
        The quantity there.
    ours : float
        The number that this version computes.
    note : str
        As in `Row`.
    by : str
        Method or integral that gives `ours`, where a quantity has several.
    """
    symbol, unit = QUANTITIES[key]
    case, quantity = f"T_m = {entry['travel_time_s']:g} s", f"{symbol} by {by}" if by else symbol
    return Row(case, quantity, unit, entry[key], ours, note, f"{place}, {case}, {symbol}" if place else "")
