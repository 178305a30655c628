"""Rolling stock of OSRD: JSON 3.0 to 3.4, a vehicle."""

import math
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, Notes
from railjoule.core.imports.source_file import SourceFile, read_json
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import counted, validated
from railjoule.core.units import MS_PER_KMH, N_PER_KN

KNOWN_VERSIONS = ("3.0", "3.4")
"""The first and the last that are known."""
LISTS = ("results", "rolling_stocks")
"""Keys of a list of rolling stocks: that of a page of answers, and that of an infrastructure."""
PER_MASS_SINCE = (3, 4)
"""From this version on, resistance is that of a kilogram."""
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Amounts = Annotated[tuple[NotNegative, ...], Field(min_length=2, max_length=1000)]


class EffortCurve(Foreign):
    """Largest tractive efforts [N] at speeds [m/s]."""

    speeds: Amounts
    max_efforts: Amounts


class ModeCurves(Foreign):
    """The curves of one supply, and the one that holds where no condition is met."""

    default_curve: EffortCurve
    curves: tuple[Any, ...] = Field((), max_length=10_000)
    is_electric: bool = True


class EffortCurves(Foreign):
    """The curves of all supplies."""

    default_mode: str
    modes: dict[str, ModeCurves] = Field(min_length=1)


class DavisResistance(Foreign):
    """Running resistance A + B v + C v2 [N, m/s]."""

    constant: NotNegative = Field(alias="A")
    linear: NotNegative = Field(alias="B")
    quadratic: NotNegative = Field(alias="C")
    type: Literal["davis"] = "davis"


class Gamma(Foreign):
    """The deceleration of braking, as older versions have it."""

    value: Positive


class RollingStock(Foreign):
    """A vehicle of OSRD."""

    railjson_version: str = ""
    name: str = Field(max_length=200)
    length: Number
    mass: Positive
    max_speed: Positive
    comfort_acceleration: Positive | None = None
    inertia_coefficient: Number = Field(ge=1)
    const_gamma: Positive | None = None
    gamma: Gamma | None = None
    rolling_resistance: DavisResistance
    effort_curves: EffortCurves


def read_osrd_stock(source: SourceFile, mode: str | None = None, wanted: str | None = None) -> ImportedVehicle:
    """Return a vehicle of a file of rolling stock.

    Parameters
    ----------
    source : SourceFile
        JSON of version 3.0 to 3.4, one rolling stock or a list of them; of other versions what is known is read.
    mode : str, optional
        The supply whose efforts are taken, such as '25000V'; by default the file's.
    wanted : str, optional
        The name of the rolling stock; by default the only one.

    Raises
    ------
    ChoiceError
        If there are several and none is named.
    ScenarioError
        If anything is wrong with the file; the sentence names field, value and bound.
    """
    notes, stocks = Notes(source.name), read_stocks(source)
    names = [str(stock.get("name", f"{number}")) for number, stock in enumerate(stocks, 1)]
    stock = validated(RollingStock, stocks[notes.chosen(names, wanted, "train")], source.name)
    notes.add_unknown_keys(stock)
    version = notes.version("railjson_version", stock.railjson_version, KNOWN_VERSIONS)
    davis, factor = stock.rolling_resistance, stock.mass if version >= PER_MASS_SINCE else 1.0
    table = {
        "name": stock.name,
        "tare_kg": stock.mass,
        "rotating_mass_factor": stock.inertia_coefficient - 1,
        "length_m": stock.length,
        "resistance": {
            "constant_n": factor * davis.constant,
            "linear_n_per_kmh": factor * davis.linear * MS_PER_KMH,
            "quadratic_n_per_kmh2": factor * davis.quadratic * MS_PER_KMH**2,
        },
        "traction": {
            "max_speed_kmh": stock.max_speed / MS_PER_KMH,
            "curve": _curve(stock.effort_curves, mode, notes),
            "max_acceleration_ms2": stock.comfort_acceleration,
        },
        "braking": _braking(stock, notes),
    }
    return imported_vehicle(table, notes)


def read_stocks(source: SourceFile) -> list[dict[str, Any]]:
    """Return the rolling stocks of a file: the one that it is, or those of its list.

    Raises
    ------
    ScenarioError
        If it is no JSON, or a list of something else.
    """
    document: Any = read_json(source, lists=True)
    if isinstance(document, dict):
        document = next((document[key] for key in LISTS if isinstance(document.get(key), list)), [document])
    if not document or not all(isinstance(one, dict) for one in document):
        raise ScenarioError(f"{source.name}: its list must hold rolling stocks, each a JSON object.")
    return list(document)


def _curve(curves: EffortCurves, mode: str | None, notes: Notes) -> list[list[float]]:
    """Read the maximum tractive efforts over speed of a supply if no condition is met."""
    names = list(curves.modes)
    name = names[notes.chosen(names, curves.default_mode if mode is None else mode, "mode")]
    chosen = curves.modes[name]
    if chosen.curves:
        notes.add_unused(f"{counted(len(chosen.curves), 'curve')} of {name} under conditions.")
    if not chosen.is_electric:
        notes.add("question", f"{name} is not electric: its efforts are taken, and its energy counts as electric.")
    speeds, efforts = chosen.default_curve.speeds, chosen.default_curve.max_efforts
    where = f"effort_curves.modes.{name}.default_curve"
    if len(speeds) != len(efforts):
        raise ScenarioError(f"{notes.source}: {where} has {len(speeds)} speeds and {len(efforts)} max_efforts.")
    # a speed that stands twice is a step; of more points at one speed only the first and the last are its sides
    points = [
        [speed / MS_PER_KMH, effort / N_PER_KN]
        for before, speed, effort, later in zip((-1.0, *speeds), speeds, efforts, (*speeds[1:], math.inf), strict=False)
        if not before == speed == later
    ]
    if steps := sum(one[0] == other[0] for one, other in pairwise(points)):
        notes.add("reading", f"{where}: {counted(steps, 'step')} of the effort, at which the lower one holds.")
    return points


def _braking(stock: RollingStock, notes: Notes) -> dict[str, float]:
    """Return brakes with the deceleration of the file: friction brakes, as it contains no electric one."""
    gamma = stock.const_gamma if stock.const_gamma is not None else stock.gamma.value if stock.gamma else None
    if gamma is None:
        raise ScenarioError(f"{notes.source}: const_gamma is missing.")
    sentence = f"no electric brake is given: friction brakes for {gamma:g} m/s2, and nothing goes back."
    notes.add("assumption", sentence)
    return {
        "max_effort_kn": 0.0,
        "friction_effort_kn": stock.mass * stock.inertia_coefficient * gamma / N_PER_KN,
        "max_deceleration_ms2": gamma,
    }
