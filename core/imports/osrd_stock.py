"""Rolling stock of OSRD: JSON 3.0 to 3.4, a vehicle."""

import math
import re
from typing import Annotated, Any, Literal

from pydantic import Field

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports.findings import Foreign, Notes, unknown_keys
from railjoule.core.imports.source_file import SourceFile, json_of
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import counted, show, shown_list, validated
from railjoule.core.units import MS_PER_KMH, N_PER_KN

KNOWN_VERSIONS = ((3, 0), (3, 4))
"""The first and the last that are known."""
LISTS = ("results", "rolling_stocks")
"""Keys of a list of rolling stocks: that of a page of answers, and that of an infrastructure."""
PER_MASS_SINCE = (3, 4)
"""From this version on, resistance is that of a kilogram."""
Effort = Annotated[Number, Field(ge=0)]
Speed = Annotated[Number, Field(ge=0)]


class EffortCurve(Foreign):
    """Largest tractive efforts [N] at speeds [m/s]."""

    speeds: tuple[Speed, ...] = Field(min_length=2, max_length=1000)
    max_efforts: tuple[Effort, ...] = Field(min_length=2, max_length=1000)


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

    constant: Effort = Field(alias="A")
    linear: Effort = Field(alias="B")
    quadratic: Effort = Field(alias="C")
    type: Literal["davis"] = "davis"


class Gamma(Foreign):
    """The deceleration of braking, as older versions have it."""

    value: Number = Field(gt=0)


class RollingStock(Foreign):
    """A vehicle of OSRD."""

    railjson_version: str = ""
    name: str = Field(max_length=200)
    length: Number
    mass: Number = Field(gt=0)
    max_speed: Number = Field(gt=0)
    comfort_acceleration: Number | None = Field(None, gt=0)
    inertia_coefficient: Number = Field(ge=1)
    const_gamma: Number | None = Field(None, gt=0)
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
    notes = Notes(source.name)
    stock = validated(RollingStock, _chosen(stocks_of(source), wanted, notes), source.name)
    notes.add_unused(unknown_keys(stock))
    version = _version(stock.railjson_version, notes)
    traction = {
        "max_speed_kmh": stock.max_speed / MS_PER_KMH,
        **_curve(stock.effort_curves, mode, notes),
    }
    if stock.comfort_acceleration is not None:
        traction["max_acceleration_ms2"] = stock.comfort_acceleration
    table = {
        "name": stock.name,
        "tare_kg": stock.mass,
        "rotating_mass_factor": stock.inertia_coefficient - 1,
        "length_m": stock.length,
        "resistance": _resistance(stock, version),
        "traction": traction,
        "braking": _braking(stock, notes),
        "drive": {"model": "constant_efficiency", "traction_efficiency": 1.0},
    }
    notes.add("assumption", "it tells no losses: a drive without losses.")
    return imported_vehicle(table, notes)


def stocks_of(source: SourceFile) -> list[dict[str, Any]]:
    """Return the rolling stocks of a file: the one that it is, or those of its list.

    Raises
    ------
    ScenarioError
        If it is no JSON, or a list of something else.
    """
    document: Any = json_of(source, lists=True)
    if isinstance(document, dict):
        document = next((document[key] for key in LISTS if isinstance(document.get(key), list)), [document])
    if not document or not all(isinstance(one, dict) for one in document):
        raise ScenarioError(f"{source.name}: its list must hold rolling stocks, each a JSON object.")
    return list(document)


def _chosen(stocks: list[dict[str, Any]], wanted: str | None, notes: Notes) -> dict[str, Any]:
    """Select the rolling stock of a name, or the only one."""
    names = [str(stock.get("name", f"{number}")) for number, stock in enumerate(stocks, 1)]
    if wanted is None and len(names) > 1:
        raise ChoiceError(notes.source, "train", tuple(names))
    if wanted is not None and wanted not in names:
        known = shown_list(names)
        raise ScenarioError(f"{notes.source}: there is no train with the name {show(wanted)}, only {known}.")
    index = 0 if wanted is None else names.index(wanted)
    others = [*names[:index], *names[index + 1 :]]
    if others:
        notes.add_unused(f"trains: {shown_list(others)}.")
    return stocks[index]


def _version(text: str, notes: Notes) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,4})\.(\d{1,4})", text)
    first, last = KNOWN_VERSIONS
    version = (int(found[1]), int(found[2])) if found else last
    if found and first <= version <= last:
        return version
    what = f"its railjson_version is {show(text)}" if text else "it has no railjson_version"
    notes.add("question", f"{what}, and 3.0 to 3.4 are known: what is known of it was read as 3.4 has it.")
    return last


def _resistance(stock: RollingStock, version: tuple[int, int]) -> dict[str, float]:
    """Return the resistance of the train, with speed in km/h."""
    davis, mass = stock.rolling_resistance, stock.mass if version >= PER_MASS_SINCE else 1.0
    return {
        "constant_n": mass * davis.constant,
        "linear_n_per_kmh": mass * davis.linear * MS_PER_KMH,
        "quadratic_n_per_kmh2": mass * davis.quadratic * MS_PER_KMH**2,
    }


def _curve(curves: EffortCurves, mode: str | None, notes: Notes) -> dict[str, Any]:
    """Read the maximum tractive efforts over speed of a supply if no condition is met."""
    name = curves.default_mode if mode is None else mode
    if name not in curves.modes:
        raise ScenarioError(f"{notes.source}: mode = {show(name)} must be one of {shown_list(list(curves.modes))}.")
    chosen = curves.modes[name]
    others = [other for other in curves.modes if other != name]
    if others:
        notes.add_unused(f"the efforts of the supplies {shown_list(others)}.")
    if chosen.curves:
        notes.add_unused(f"{counted(len(chosen.curves), 'curve')} of {name} under conditions.")
    if not chosen.is_electric:
        notes.add("question", f"{name} is not electric: its efforts are taken, and its energy counts as electric.")
    speeds, efforts = chosen.default_curve.speeds, chosen.default_curve.max_efforts
    where = f"effort_curves.modes.{name}.default_curve"
    if len(speeds) != len(efforts):
        raise ScenarioError(f"{notes.source}: {where} has {len(speeds)} speeds and {len(efforts)} max_efforts.")
    # a speed that stands twice is a step, for which our curves have no room: the effort beyond it holds
    points = [
        [speed / MS_PER_KMH, effort / N_PER_KN]
        for speed, effort, later in zip(speeds, efforts, (*speeds[1:], math.inf), strict=True)
        if speed != later
    ]
    if steps := len(speeds) - len(points):
        notes.add("reading", f"{where}: {counted(steps, 'step')} of the effort: that beyond counts.")
    return {"curve": points}


def _braking(stock: RollingStock, notes: Notes) -> dict[str, float]:
    """Return brakes with the deceleration of the file: friction brakes, as it contains no electric one."""
    gamma = stock.const_gamma if stock.const_gamma is not None else stock.gamma.value if stock.gamma else None
    if gamma is None:
        raise ScenarioError(f"{notes.source}: const_gamma is missing.")
    sentence = f"it tells of no electric brake: friction brakes for {gamma:g} m/s2, and nothing goes back."
    notes.add("assumption", sentence)
    return {
        "max_effort_kn": 0.0,
        "friction_effort_kn": stock.mass * stock.inertia_coefficient * gamma / N_PER_KN,
        "max_deceleration_ms2": gamma,
    }
