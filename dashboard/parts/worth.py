"""The worth of a saving over a year."""

from typing import NamedTuple

DAYS_A_YEAR = 365
KWH_PER_MWH, KG_PER_T = 1e3, 1e3


class YearlySaving(NamedTuple):
    """Energy [MWh], money [in the currency of the price] and carbon dioxide [t] saved in a year; negative if lost."""

    energy_mwh: float
    money: float
    co2_t: float


def yearly_saving(saved_kwh: float, trains_per_day: float, price_per_kwh: float, co2_kg_per_kwh: float) -> YearlySaving:
    """Return the saving of a year of 365 days, if each train of a day saves the same energy.

    Parameters
    ----------
    saved_kwh : float
        Saving of one run [kWh].
    trains_per_day : float
    price_per_kwh : float
    co2_kg_per_kwh : float
        Carbon dioxide emitted per energy from the supply [kg/kWh].
    """
    yearly_kwh = saved_kwh * trains_per_day * DAYS_A_YEAR
    return YearlySaving(yearly_kwh / KWH_PER_MWH, yearly_kwh * price_per_kwh, yearly_kwh * co2_kg_per_kwh / KG_PER_T)
