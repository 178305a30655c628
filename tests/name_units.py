"""The units that names of quantities end in, for the tests of core and dashboard."""

UNITS = {
    "_a": "A",
    "_h": "H",
    "_hz": "Hz",
    "_j": "J",
    "_kg": "kg",
    "_t": "t",
    "_km": "km",
    "_kmh": "km/h",
    "_kn": "kN",
    "_kw": "kW",
    "_kwh": "kWh",
    "_m": "m",
    "_m2": "m2",
    "_m_n_per_kn": "N m/kN",
    "_mh": "mH",
    "_mm": "mm",
    "_ms": "m/s",
    "_ms2": "m/s2",
    "_ms3": "m/s3",
    "_n": "N",
    "_n_per_kmh": "N/(km/h)",
    "_n_per_kmh2": "N/(km/h)2",
    "_n_per_kn": "N/kN",
    "_n_per_kn_per_kmh": "N/kN/(km/h)",
    "_n_per_kn_per_kmh2": "N/kN/(km/h)2",
    "_nm": "N m",
    "_ohm": "ohm",
    "_per_m": "1/m",
    "_per_metre": "1/m",
    "_per_newton": "A/N",
    "_min_per_100km": "min/100 km",
    "_permille": "per mille",
    "_rads": "rad/s",
    "_s": "s",
    "_v": "V",
    "_vs": "V s",
    "_w": "W",
    "_w_per_nm": "W/(N m)",
    "_w_per_nm2": "W/(N m)2",
    "_w_per_rads": "W/(rad/s)",
    "_w_per_rads2": "W/(rad/s)2",
    "_w_per_rads3": "W/(rad/s)3",
    "_ws": "W s",
    "_ws2": "W s2",
    "reserve_percent": "%",
    "speed2": "m2/s2",
    "torque_per_amp_nm": "N m/A",
}
"""How the end of a name tells its unit; the longest that fits counts."""


WITHOUT_UNIT = {
    *("k1", "k3", "k5", "k6", "ka", "ks"),  # coefficients of a paper keep its names
    *("effort", "power", "speed"),  # compiled code of drives
    *("inertia", "linear", "quadratic", "resistance_linear", "resistance_quadratic", "loss_coefficient"),
    "curve",  # pairs of two units
}
"""Names whose unit only the file tells."""


def unit_of(name: str) -> str:
    """Return the unit that the end of a name tells, '1' where it tells none."""
    endings = [ending for ending in UNITS if name.endswith(ending)]
    return UNITS[max(endings, key=len)] if endings else "1"
