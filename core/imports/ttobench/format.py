"""The files of TTOBench, a library of tracks, trains and journeys for train trajectory optimisation: 1.1 to 1.5."""

import re
from typing import Annotated, Any

from pydantic import Field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.foreign import Foreign
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show
from railjoule.core.units import MS_PER_KMH, N_PER_KN

KNOWN_VERSIONS = ((1, 1), (1, 5))
"""The first and the last that are known."""
M_UNITS = {"m": 1.0, "km": 1000.0}
KG_UNITS = {"kg": 1.0, "t": 1000.0}
KW_UNITS = {"kW": 1.0, "W": 1e-3, "MW": 1e3}
KN_UNITS = {"kN": 1.0, "N": 1e-3}
KMH_UNITS = {"km/h": 1.0, "m/s": 1 / MS_PER_KMH}
MS2_UNITS = {"m/s^2": 1.0}
SHARE_UNITS = {"%": 0.01, "-": 1.0}
PERMILLE_UNITS = {"permil": 1.0, "\u2030": 1.0, "%": 10.0}
SECOND_UNITS = {"s": 1.0, "min": 60.0}
AREA_UNITS = {"m^2": 1.0}
N_PER_KMH_UNITS = {
    "kN/(km/h)": N_PER_KN,
    "N/(km/h)": 1.0,
    "kN/(m/s)": N_PER_KN * MS_PER_KMH,
    "N/(m/s)": MS_PER_KMH,
}
N_PER_KMH2_UNITS = {
    "kN/(km/h)^2": N_PER_KN,
    "N/(km/h)^2": 1.0,
    "kN/(m/s)^2": N_PER_KN * MS_PER_KMH**2,
    "N/(m/s)^2": MS_PER_KMH**2,
}
"""What one of each unit is in the unit that our keys have."""
Positive = Annotated[Number, Field(ge=0)]


class Metadata(Foreign):
    """What a file is."""

    id: str = Field(max_length=200)
    library_version: str = Field("", alias="library version")


class Quantity(Foreign):
    """A number and its unit."""

    unit: str
    value: Number


class Stops(Foreign):
    """Where trains may stop; the track reaches from the first to the last."""

    unit: str
    values: tuple[Number, ...] = Field(min_length=2, max_length=1000)


class Pairs(Foreign):
    """Values that hold from a position on."""

    units: dict[str, str]
    values: tuple[tuple[Number, Number], ...] = Field(min_length=1, max_length=100_000)


class Curvatures(Foreign):
    """Radii at the begin and at the end of a curve or a transition, or 'infinity'."""

    units: dict[str, str]
    values: tuple[tuple[Number, Number | str, Number | str], ...] = Field(min_length=1, max_length=100_000)


class Tunnels(Foreign):
    """Begin, length and cross section of tunnels."""

    units: dict[str, str]
    values: tuple[tuple[Number, Positive, Positive], ...] = Field(max_length=10_000)


class Track(Foreign):
    """A line."""

    metadata: Metadata
    stops: Stops
    speed_limits: Pairs = Field(alias="speed limits")
    gradients: Pairs | None = None
    curvatures: Curvatures | None = None
    tunnels: Tunnels | None = None


class TunnelResistance(Foreign):
    """What is added to the quadratic term of resistance in tunnels of some cross sections."""

    units: dict[str, str]
    values: tuple[tuple[Positive, Positive], ...] = Field(min_length=1, max_length=1000)


class Train(Foreign):
    """A vehicle."""

    metadata: Metadata
    coaches: Quantity | None = Field(None, alias="num coaches")
    length: Quantity | None = None
    mass: Quantity
    rho: Quantity | None = None
    traction_power: Quantity = Field(alias="max traction power")
    braking_power: Quantity = Field(alias="max reg braking power")
    traction_force: Quantity = Field(alias="max traction force")
    braking_force: Quantity = Field(alias="max reg braking force")
    pneumatic_force: Quantity | None = Field(None, alias="max pn braking force")
    acceleration: Quantity | None = Field(None, alias="max acceleration")
    deceleration: Quantity | None = Field(None, alias="max deceleration")
    speed: Quantity = Field(alias="max speed")
    r0: Quantity = Field(alias="rolling resistance r0")
    r1: Quantity = Field(alias="rolling resistance r1")
    r2: Quantity = Field(alias="rolling resistance r2")
    traction_efficiency: Quantity | None = Field(None, alias="efficiency traction")
    braking_efficiency: Quantity | None = Field(None, alias="efficiency reg brake")
    tunnel_resistance: TunnelResistance | None = Field(None, alias="tunnel resistance")


TimingPoint = tuple[Number, Number | None, Number | None, Number | None, Number | None]


class TimingPoints(Foreign):
    """Position, least and largest time, least and largest speed; an empty one is free."""

    units: dict[str, str]
    values: tuple[TimingPoint, ...] = Field(min_length=2, max_length=2000)


class Journey(Foreign):
    """When a train is where."""

    metadata: Metadata
    timing_points: TimingPoints = Field(alias="timing points")


def factor_of(unit: Any, units: dict[str, float], place: str) -> float:
    """Return what one of a unit is in ours.

    Raises
    ------
    ScenarioError
        If the unit is not known; the sentence begins with `place`.
    """
    if unit not in units:
        raise ScenarioError(f"{place} = {show(unit)} must be one of {', '.join(units)}.")
    return units[unit]


def column_factor(units: dict[str, str], column: str, known: dict[str, float], place: str) -> float:
    """Return what one of a column's unit is in ours; without one it is the first of those known."""
    return factor_of(units.get(column, next(iter(known))), known, f"{place}.units.{column}")


def version_findings(metadata: Metadata, source: str) -> list[Finding]:
    """Return what to say of a file of a version that is not known."""
    found = re.search(r"(\d{1,4})\.(\d{1,4})", metadata.library_version)
    first, last = KNOWN_VERSIONS
    if found and first <= (int(found[1]), int(found[2])) <= last:
        return []
    told = (
        f"its library version is {show(metadata.library_version)}" if metadata.library_version else "it has no version"
    )
    return [Finding("question", f"{source}: {told}, and 1.1 to 1.5 are known: what is known of it was read.")]
