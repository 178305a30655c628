"""The columns of a table of intervals and their units: named, in a preset, by their headings, or in doubt."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import zip_longest
from typing import Any, get_args

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable
from railjoule.core.imports.numbers import COMPOUND_UNITS, POSITION_UNITS
from railjoule.core.imports.units import (
    BRACKETS,
    Heading,
    IntervalKind,
    TableKind,
    name_tokens,
    plain,
    read_heading,
)
from railjoule.core.scenario._sentences import show, shown_list, suggestion

INTERVAL_KINDS: tuple[IntervalKind, ...] = get_args(IntervalKind)
TABLE_KINDS: tuple[TableKind, ...] = (*INTERVAL_KINDS, "stations")
"""Kinds of tables that describe a line."""
ROLES = ("from", "to", "value", "direction")
WINDOW_ROLES = ("earliest", "latest")
TIME_ROLES = ("dwell", *WINDOW_ROLES, "arrival", "departure")
STATION_ROLES = ("name", "position", *TIME_ROLES)
SETTINGS = ("position_unit", "value_unit", "decimal", "sheet", "tolerance_m")
SELECTORS = ("line", "track")
"""Columns of which one value must be chosen."""
VALUE_UNITS: Mapping[TableKind, tuple[str, ...]] = {
    "gradients": ("permille", "percent", "fraction", "ratio", "deg", "rad", "per10000", "ft/mi"),
    "limits": ("km/h", "m/s", "mph"),
    "heights": ("m", "ft"),
    "curves": ("m", "km", "ft", "yd", "ch", "mi", "deg", "deg_arc", "1/m", "1/km", "1/ft"),
    "tunnels": ("factor", "m2"),
    "neutral": (),
    "stations": ("s", "min", "h"),
}
"""Units of what a table of each kind holds; except of tunnels the first holds where none is named."""
ALL_POSITION_UNITS = (*POSITION_UNITS, *COMPOUND_UNITS)
NAMES: Mapping[str, tuple[str, ...]] = {
    role: tuple(map(plain, names))
    for role, names in {
        "from": ("from", "start", "begin", "beginning", "von", "anfang", "pkd", "pk debut", "debut", "od", "początek",
                 "начало", "початок", "起点", "起点里程", "position", "pos", "chainage", "kilometer", "km", "mileage",
                 "location", "pk", "start position", "from position", "milepost", "里程"),
        "to": ("to", "end", "bis", "ende", "pkf", "pk fin", "fin", "do", "koniec", "конец", "кінець", "终点",
               "终点里程", "end position", "to position"),
        "gradients": ("gradient", "slope", "grade", "inclination", "neigung", "längsneigung", "declivite", "valeur",
                      "value", "permille", "steigung", "ill gradprofile", "pochylenie", "уклон", "ухил", "坡度"),
        "limits": ("limit", "speed limit", "speed", "v max", "vmax", "max speed", "maxspeed", "vitesse", "line speed",
                   "linespeed",
                   "geschwindigkeit", "höchstgeschwindigkeit", "value", "velocity", "permitted speed",
                   "v", "prędkość", "скорость", "швидкість", "限速"),
        "curves": ("radius", "rayon", "curve radius", "r", "halbmesser", "value", "degree of curve", "curvature",
                   "promień", "радиус", "радіус", "半径", "曲线半径"),
        "tunnels": ("factor", "tunnel factor", "cross section", "area", "querschnitt", "section", "value"),
        "neutral": (),
        "heights": ("height", "elevation", "altitude", "ele", "elev", "alt", "höhe", "wysokość", "rzędna", "высота",
                    "отметка", "висота", "高程", "标高", "value"),
        "name": ("station name", "stop name", "name", "station", "stop", "stop id", "bahnhof", "haltestelle",
                 "betriebsstelle", "gare", "nom", "stacja", "станция", "станція", "车站", "站名"),
        "position": ("position", "pos", "chainage", "kilometer", "kilometre", "km", "mileage", "milepost", "location",
                     "pk", "distance", "shape dist traveled", "kilometraż", "里程"),
        "dwell": ("dwell", "dwell time", "stop time", "haltezeit", "aufenthalt", "temps d arret", "postój", "стоянка",
                  "停站时间"),
        "earliest": ("earliest arrival", "earliest"),
        "latest": ("latest arrival", "latest"),
        "arrival": ("arrival", "arrival time", "arr", "ankunft", "an", "arrivee", "przyjazd", "прибытие", "прибуття",
                    "到达"),
        "departure": ("departure", "departure time", "dep", "abfahrt", "ab", "depart", "odjazd", "отправление",
                      "відправлення", "出发"),
        "line": ("line", "code ligne", "strecke", "line code", "route", "ligne"),
        "track": ("track", "nom voie", "voie", "gleis"),
        "sense": ("direction", "sens", "richtung", "kierunek", "направление", "напрям", "方向"),
    }.items()
}  # fmt: skip
"""Words by which a column is known, the likeliest first."""
WORDS_OF_NAMES = frozenset(word for names in NAMES.values() for name in names for word in name.split())
FALLS, RISES, IS_LEVEL = ("pente", "fall", "gefalle", "gefaelle", "down"), ("rampe", "rise", "up"), ("palier", "level")
"""Words of a column of directions, as they begin."""
ONE_WAY = frozenset({"forward", "backward"})
"""Words of columns that hold in one direction only, as OpenStreetMap's maxspeed:forward."""
LARGEST_TOLERANCE_M = 100.0


@dataclass(frozen=True)
class ColumnMap:
    """Which columns of a table hold what, and in which units; None is guessed from their names.

    Parameters
    ----------
    columns : mapping of str to str
        The columns 'from', 'to', 'value', and 'direction', whose texts say whether a gradient falls.
        Of stations they are `STATION_ROLES`.
    position_unit : str or None
        m, km, mi, ch, yd, ft, pk (012+345), mi.ch (12.34 is 12 miles 34 chains) or mi.yd.
    value_unit : str or None
        As in `VALUE_UNITS`; ratio is 1 in so many, ft/mi feet a mile, deg of curves the degree of curve over a chord,
        deg_arc that over an arc. Of stations it is the unit of times.
    decimal : str or None
        The decimal sign, '.' or ','.
    rows : mapping of str to str
        Rows are used where these columns have these values.
    sheet : str or None
        The sheet of a workbook, or the track of a GPX file; by default its only one.
    tolerance_m : float or None
        By how much the line may lie above or below heights [m]; None is `heights.USUAL_TOLERANCE_M`.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    position_unit: str | None = None
    value_unit: str | None = None
    decimal: str | None = None
    rows: Mapping[str, str] = field(default_factory=dict)
    sheet: str | None = None
    tolerance_m: float | None = None

    @classmethod
    def of(cls, key: str, value: str) -> "ColumnMap":
        """Make a map of one setting, such as 'from' and a column, or 'decimal' and a sign."""
        settings: dict[str, Any] = {key: value} if key in SETTINGS else {"columns": {key: value}}
        if key == "tolerance_m":
            try:
                settings = {key: float(value)}
            except ValueError:
                raise ScenarioError(f"heights.tolerance_m = {show(value)} must be a number.") from None
        return cls(**settings)

    def over(self, base: "ColumnMap") -> "ColumnMap":
        """Return this map with what it leaves open taken from `base`."""
        kept = {one.name: getattr(self, one.name) for one in fields(self) if getattr(self, one.name) is not None}
        return replace(
            base, **{**kept, "columns": {**base.columns, **self.columns}, "rows": {**base.rows, **self.rows}}
        )


PRESETS: Mapping[str, tuple[IntervalKind, ColumnMap]] = {
    # the columns' names are those of the tables that the French infrastructure manager publishes
    "sncf-limits": ("limits", ColumnMap({"from": "pkd", "to": "pkf", "value": "v_max"}, "pk", "km/h")),
    "sncf-gradients": (
        "gradients",
        ColumnMap({"from": "PKD", "to": "PKF", "value": "VALEUR", "direction": "TYPE"}, "pk", "permille"),
    ),
    "sncf-curves": ("curves", ColumnMap({"from": "PKD", "to": "PKF", "value": "RAYON"}, "pk", "m")),
    "rinf-gradients": ("gradients", ColumnMap({"value": "ILL_GradProfile"}, "km", "permille")),
}
"""Tables that are published, each with its kind and columns."""


@dataclass(frozen=True)
class ResolvedColumns:
    """The columns of one table by role, None if there is none, and their units as headings or user name them."""

    begin: str
    end: str | None
    value: str | None
    direction: str | None
    position: Heading
    amount: Heading


def resolve(cells: CellTable, kind: IntervalKind, wanted: ColumnMap) -> ResolvedColumns:
    """Find the column of each role in a table.

    Raises
    ------
    ScenarioError
        If a column that is named is missing, or one that is needed is not recognised.
    """
    named = require_known(cells, kind, ROLES, wanted)
    if cells.has_header:
        chosen = guess_columns(cells, kind, ("from", "value") if kind == "heights" else ("from", "to", "value"), named)
    else:
        chosen = {**_by_place(cells, kind), **named}
    begin, end = chosen["from"], chosen.get("to")
    value = None if kind == "neutral" else chosen["value"]  # a stretch is neutral or not
    choices = f"COLUMN, of {shown_list(list(cells.header))}."
    if begin is None:
        what = "contains the position" if kind == "heights" else "has the start of each row"
        raise ScenarioError(f"{cells.source}: no column {what}; name it, as {kind}.from={choices}")
    if value is None and kind not in {"tunnels", "neutral"}:
        raise ScenarioError(f"{cells.source}: no column of {kind} was found; name it, as {kind}.value={choices}")
    direction = named.get("direction") or (_directions(cells) if kind == "gradients" else None)
    position = _position_heading({"from": begin, "to": end}, named, wanted)
    amount = Heading()
    if wanted.value_unit is None and value is not None and VALUE_UNITS[kind]:
        amount = read_heading(value, kind, None if "value" in named else WORDS_OF_NAMES)
    return ResolvedColumns(begin, end, value, direction, position, amount)


def resolve_stations(cells: CellTable, wanted: ColumnMap) -> tuple[dict[str, str | None], ResolvedColumns]:
    """Find the column of each role of `STATION_ROLES`, None if there is none, and that of positions with its unit.

    Raises
    ------
    ScenarioError
        As of `resolve`.
    """
    named = require_known(cells, "stations", STATION_ROLES, wanted)
    chosen = guess_columns(cells, "stations", STATION_ROLES, named)
    # windows are those of arrivals, not of departures
    others = {**dict.fromkeys(WINDOW_ROLES, NAMES["departure"]), "departure": WINDOW_ROLES, "arrival": WINDOW_ROLES}
    for role, words in others.items():
        if role not in named and set(words) & set(_name_words(chosen[role] or "").split()):
            chosen[role] = None
    if (begin := chosen["position"]) is None:
        choices = f"COLUMN, of {shown_list(list(cells.header))}."
        raise ScenarioError(
            f"{cells.source}: no column contains the position of each station; name it, as stations.position={choices}"
        )
    heading = _position_heading({"position": begin}, named, wanted)
    return chosen, ResolvedColumns(begin, None, None, None, heading, Heading())


def _position_heading(columns: Mapping[str, str | None], named: Mapping[str, str], wanted: ColumnMap) -> Heading:
    """Read the unit that the columns of positions name; one of them may leave it to the other."""
    if wanted.position_unit:
        return Heading(wanted.position_unit)
    headings = [
        read_heading(column, "positions", None if role in named else WORDS_OF_NAMES)
        for role, column in columns.items()
        if column is not None
    ]
    doubt = next((heading.doubt for heading in headings if heading.doubt), "")
    units = list(dict.fromkeys(heading.unit for heading in headings if heading.unit))
    if len(units) > 1 and not doubt:
        doubt = f"{' and '.join(map(repr, columns.values()))} name two units, {' and '.join(units)}"
    return Heading(units[0] if units else None, doubt)


def line_selectors(cells: CellTable, kind: TableKind, used: Collection[str]) -> list[str]:
    """List the columns of a line, a track or, of limits, a direction, except those that are `used` otherwise."""
    # not of curves, which may turn left and right, nor of gradients, whose direction is their sign
    roles = (*SELECTORS, "sense") if kind == "limits" else SELECTORS
    names = {name for role in roles for name in NAMES[role]}
    return [column for column in cells.header if column not in used and _name_words(column) in names]


def has_name(column: str, names: Collection[str]) -> bool:
    """Return whether a column has one of some names, whatever its unit."""
    return _name_words(column) in names


def same_name(one: str, other: str) -> bool:
    """Tell whether two names of columns differ only in capitals, accents and signs."""
    return _words(one) == _words(other)


def require_known(cells: CellTable, kind: TableKind, roles: Sequence[str], wanted: ColumnMap) -> dict[str, str]:
    """Find the columns that the user names; ScenarioError if one of them, a role or a unit is unknown."""
    source = cells.source
    for name in wanted.columns:
        if name not in roles:
            raise ScenarioError(f"{source}: {kind}.{name} is unknown, {_hint(name, roles)}")
    tolerance = wanted.tolerance_m
    if tolerance is not None and (kind != "heights" or not 0 <= tolerance <= LARGEST_TOLERANCE_M):
        bound = f"0 to {LARGEST_TOLERANCE_M:g} m" if kind == "heights" else "left out: only heights have one"
        raise ScenarioError(f"{source}: {kind}.tolerance_m = {tolerance:g} must be {bound}.")
    for key, words, known in (
        ("position_unit", "one of ", ALL_POSITION_UNITS),
        ("value_unit", "one of ", VALUE_UNITS[kind] or ("left out",)),
        ("decimal", "", (".", ",")),
    ):
        given = getattr(wanted, key)
        if given is not None and given not in known:
            choices = (", " if words else " or ").join(known)
            raise ScenarioError(f"{source}: {kind}.{key} = {show(given)} must be {words}{choices}.")
    return {role: _column(cells, role, name) for role, name in wanted.columns.items()}


def _hint(name: str, known: Collection[str]) -> str:
    hint = suggestion(name, known)
    return hint + ("" if hint.endswith("?") else ".")


def _column(cells: CellTable, role: str, name: str) -> str:
    """Find a column by its name, in whichever capitals and accents the file has it."""
    alike = [column for column in cells.header if same_name(column, name)]
    if name not in cells.header and not alike:
        hint = _hint(name, cells.header)
        raise ScenarioError(f"{cells.source}: {role} = {show(name)} is not a column of it, {hint}")
    return name if name in cells.header else alike[0]


def guess_columns(
    cells: CellTable, kind: TableKind, roles: Sequence[str], named: Mapping[str, str]
) -> dict[str, str | None]:
    """Find the column of each role, one after the other among those that are left."""
    chosen: dict[str, str | None] = dict(named)
    for role in roles:
        free = [column for column in cells.header if column not in chosen.values()]
        chosen[role] = named.get(role) or _guessed(cells.source, kind, free, role)
    return chosen


def _guessed(source: str, kind: TableKind, free: list[str], role: str) -> str | None:
    """Find the column with the likeliest name, None if there is none; ScenarioError if two are equally likely."""
    # heights are those of places
    names = NAMES[kind if role == "value" else "position" if kind == "heights" and role == "from" else role]
    words = {column: _name_words(column) for column in free}
    for is_whole in (True, False):
        for name in names:
            found = [
                column
                for column, text in words.items()
                if text == name or (not is_whole and f" {name} " in f" {text} ")
            ]
            if len(found) > 1:
                raise ScenarioError(
                    f"{source}: {show(found[0])} and {show(found[1])} may both be the column {role!r}; name one, as "
                    f"{kind}.{role}=COLUMN."
                )
            if found:
                return found[0]
    return None


def one_way_column(cells: CellTable, kind: IntervalKind, wanted: ColumnMap) -> str | None:
    """Find the only column of a kind that counts in one direction, such as maxspeed:forward.

    Raises
    ------
    ScenarioError
        If others stand beside it: which of them counts for the run, the table cannot say.
    """
    words = {column: set(_words(column).split()) for column in cells.header}
    one_way = [column for column in cells.header if ONE_WAY & words[column]]
    if kind == "neutral" or "value" in wanted.columns or not one_way:
        return None
    if sum(words[one_way[0]] - ONE_WAY <= words[column] for column in cells.header) > 1:
        raise ScenarioError(
            f"{cells.source}: {show(one_way[0])} counts in one direction only; name the column for this run, as "
            f"{kind}.value=COLUMN, with a value in each row."
        )
    return one_way[0]


def _by_place(cells: CellTable, kind: IntervalKind) -> dict[str, str | None]:
    """Assign the columns of a table without names: from, to and value, or from and value."""
    columns = list(cells.header)
    if len(columns) > 3:
        raise ScenarioError(f"{cells.source}: {len(columns)} columns without names; the first row must name them.")
    if len(columns) == 2 and kind in {"gradients", "heights", "limits", "curves"}:
        return {"from": columns[0], "to": None, "value": columns[1]}
    return dict(zip_longest(("from", "to", "value"), columns))


def _directions(cells: CellTable) -> str | None:
    """Find the column of a text for each row on whether it falls, rises or is level."""
    for column in cells.header:
        texts = [direction_word(cell) for _, cell in cells.column(column) if cell != ""]
        if texts and all(text.startswith((*FALLS, *RISES, *IS_LEVEL)) for text in texts):
            return column
    return None


def direction_word(cell: Cell) -> str:
    """Normalise a cell of a column of directions to small letters without accents."""
    return _words(cell) if isinstance(cell, str) else ""


def _name_words(column: str) -> str:
    return _words(" ".join(name_tokens(column)) or BRACKETS.sub(" ", column))


def _words(text: str) -> str:
    """Normalise a column's name to small letters without accents and signs."""
    return " ".join(re.sub(r"[\W_]+", " ", plain(text)).split())
