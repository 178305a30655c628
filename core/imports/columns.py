"""Which column of a table of intervals holds what: named, as a preset has it, or guessed from the columns' names."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, get_args

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable
from railjoule.core.imports.numbers import COMPOUND_UNITS, POSITION_UNITS
from railjoule.core.imports.source_file import shown_list
from railjoule.core.imports.units import BRACKETS, Heading, IntervalKind, name_tokens, plain, read_heading
from railjoule.core.scenario._sentences import show, suggestion

INTERVAL_KINDS: tuple[IntervalKind, ...] = get_args(IntervalKind)
ROLES = ("from", "to", "value", "direction")
SETTINGS = ("position_unit", "value_unit", "decimal", "sheet")
SELECTORS = ("line", "track")
"""Columns of which one value must be chosen."""
VALUE_UNITS: Mapping[IntervalKind, tuple[str, ...]] = {
    "gradients": ("permille", "percent", "fraction", "ratio", "deg", "rad", "per10000", "ft/mi"),
    "limits": ("km/h", "m/s", "mph"),
    "curves": ("m", "km", "ft", "yd", "ch", "deg", "1/m", "1/km"),
    "tunnels": ("factor", "m2"),
    "neutral": (),
}
"""Units of what a table of each kind holds; of gradients, limits and curves the first holds where none is named."""
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
        "limits": ("limit", "speed limit", "speed", "v max", "vmax", "max speed", "maxspeed", "vitesse",
                   "geschwindigkeit", "höchstgeschwindigkeit", "value", "velocity", "permitted speed",
                   "v", "prędkość", "скорость", "швидкість", "限速"),
        "curves": ("radius", "rayon", "curve radius", "r", "halbmesser", "value", "degree of curve", "curvature",
                   "promień", "радиус", "радіус", "半径", "曲线半径"),
        "tunnels": ("factor", "tunnel factor", "cross section", "area", "querschnitt", "section", "value"),
        "neutral": (),
        "line": ("line", "code ligne", "strecke", "line code", "route", "ligne"),
        "track": ("track", "nom voie", "voie", "gleis"),
    }.items()
}  # fmt: skip
"""Words by which a column is known, the likeliest first."""
WORDS_OF_NAMES = frozenset(word for names in NAMES.values() for name in names for word in name.split())
FALLS, RISES, IS_LEVEL = ("pente", "fall", "gefalle", "gefaelle", "down"), ("rampe", "rise", "up"), ("palier", "level")
"""Words of a column of directions, as they begin."""


@dataclass(frozen=True)
class ColumnMap:
    """Which columns of a table hold what, and in which units; None is guessed from their names.

    Parameters
    ----------
    columns : mapping of str to str
        The columns 'from', 'to', 'value', and 'direction', whose texts say whether a gradient falls.
    position_unit : str or None
        m, km, mi, ch, yd, ft, pk (012+345), mi.ch (12.34 is 12 miles 34 chains) or mi.yd.
    value_unit : str or None
        As in `VALUE_UNITS`; ratio is 1 in so many, ft/mi feet a mile, deg of curves the degree of curve.
    decimal : str or None
        The decimal sign, '.' or ','.
    rows : mapping of str to str
        Rows are used where these columns have these values.
    sheet : str or None
        The sheet of a workbook; by default its only one.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    position_unit: str | None = None
    value_unit: str | None = None
    decimal: str | None = None
    rows: Mapping[str, str] = field(default_factory=dict)
    sheet: str | None = None

    @classmethod
    def of(cls, key: str, value: str) -> "ColumnMap":
        """Return what one setting says, such as 'from' and a column, or 'decimal' and a sign."""
        settings: dict[str, Any] = {key: value} if key in SETTINGS else {"columns": {key: value}}
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
    """The columns of one table by what they hold, and what is said of their units; None where there is no such column.

    The units have no doubt where the user named them.
    """

    begin: str
    end: str | None
    value: str | None
    direction: str | None
    position: Heading
    amount: Heading


def resolve(cells: CellTable, kind: IntervalKind, wanted: ColumnMap) -> ResolvedColumns:
    """Return which columns of a table hold what.

    Raises
    ------
    ScenarioError
        If a column that is named is missing, or one that is needed cannot be told.
    """
    _require_known(cells.source, kind, wanted)
    named = {role: _column(cells, role, name) for role, name in wanted.columns.items()}
    if cells.has_header:
        free = [column for column in cells.header if column not in named.values()]
        begin = named.get("from") or _guessed(cells.source, kind, free, "from")
        free = [column for column in free if column != begin]
        end = named.get("to") or _guessed(cells.source, kind, free, "to")
        free = [column for column in free if column != end]
        value = named.get("value") or _guessed(cells.source, kind, free, "value")
    else:
        begin, end, value = _by_place(cells, kind, named)
    value = None if kind == "neutral" else value  # a stretch is neutral or not
    if begin is None:
        raise ScenarioError(
            f"{cells.source}: no column says where each row begins; name it, as {kind}.from=COLUMN, of "
            f"{shown_list(list(cells.header))}."
        )
    if value is None and kind not in {"tunnels", "neutral"}:
        raise ScenarioError(
            f"{cells.source}: no column of {kind} was found; name it, as {kind}.value=COLUMN, of "
            f"{shown_list(list(cells.header))}."
        )
    direction = named.get("direction") or (_directions(cells) if kind == "gradients" else None)
    return ResolvedColumns(
        begin,
        end,
        value,
        direction,
        Heading(wanted.position_unit) if wanted.position_unit else _position_heading(begin, end, named),
        Heading(wanted.value_unit) if wanted.value_unit else _value_heading(value, kind, named),
    )


def _position_heading(begin: str, end: str | None, named: Mapping[str, str]) -> Heading:
    """Return the unit that the columns of positions name, of which one may leave it to the other."""
    headings = [
        read_heading(column, "positions", None if role in named else WORDS_OF_NAMES)
        for role, column in (("from", begin), ("to", end))
        if column is not None
    ]
    doubt = next((heading.doubt for heading in headings if heading.doubt), "")
    units = list(dict.fromkeys(heading.unit for heading in headings if heading.unit))
    if len(units) > 1 and not doubt:
        doubt = f"{begin!r} and {end!r} name two units, {' and '.join(units)}"
    return Heading(units[0] if units else None, doubt)


def _value_heading(value: str | None, kind: IntervalKind, named: Mapping[str, str]) -> Heading:
    if value is None or not VALUE_UNITS[kind]:
        return Heading()
    return read_heading(value, kind, None if "value" in named else WORDS_OF_NAMES)


def selectors_of(cells: CellTable, used: Collection[str]) -> list[str]:
    """Return the columns that tell line or track, but for those that are `used` otherwise."""
    names = [name for role in SELECTORS for name in NAMES[role]]
    return [column for column in cells.header if column not in used and any(_is_called(column, name) for name in names)]


def same_name(one: str, other: str) -> bool:
    """Return whether two names of columns differ in capitals, accents and signs alone."""
    return _words(one) == _words(other)


def _require_known(source: str, kind: IntervalKind, wanted: ColumnMap) -> None:
    for name in wanted.columns:
        if name not in ROLES:
            raise ScenarioError(f"{source}: {kind}.{_told(name, ROLES)}")
    if wanted.position_unit is not None and wanted.position_unit not in ALL_POSITION_UNITS:
        known = ", ".join(ALL_POSITION_UNITS)
        raise ScenarioError(f"{source}: {kind}.position_unit = {show(wanted.position_unit)} must be one of {known}.")
    if wanted.value_unit is not None and wanted.value_unit not in VALUE_UNITS[kind]:
        known = ", ".join(VALUE_UNITS[kind]) or "left out"
        raise ScenarioError(f"{source}: {kind}.value_unit = {show(wanted.value_unit)} must be one of {known}.")
    if wanted.decimal is not None and wanted.decimal not in {".", ","}:
        raise ScenarioError(f"{source}: {kind}.decimal = {show(wanted.decimal)} must be . or ,.")


def _told(name: str, known: tuple[str, ...]) -> str:
    hint = suggestion(name, known)
    return f"{name} is unknown, {hint}" + ("" if hint.endswith("?") else ".")


def _column(cells: CellTable, role: str, name: str) -> str:
    """Return a column by its name, in whichever capitals and accents the file has it."""
    if name in cells.header:
        return name
    alike = [column for column in cells.header if same_name(column, name)]
    if not alike:
        hint = suggestion(name, cells.header)
        end = "" if hint.endswith("?") else "."
        raise ScenarioError(f"{cells.source}: {role} = {show(name)} is not a column of it, {hint}{end}")
    return alike[0]


def _guessed(source: str, kind: IntervalKind, free: list[str], role: str) -> str | None:
    """Return the column that is known by the likeliest word, None where none is.

    Raises
    ------
    ScenarioError
        If two columns are equally likely.
    """
    for fits in (_is_called, _has_word):
        for name in NAMES[kind if role == "value" else role]:
            found = [column for column in free if fits(column, name)]
            if len(found) > 1:
                raise ScenarioError(
                    f"{source}: {show(found[0])} and {show(found[1])} may both be the column {role!r}; name one, as "
                    f"{kind}.{role}=COLUMN."
                )
            if found:
                return found[0]
    return None


def _by_place(
    cells: CellTable, kind: IntervalKind, named: Mapping[str, str]
) -> tuple[str | None, str | None, str | None]:
    """Return the columns of a table without names: from, to and value, or from and value."""
    columns = list(cells.header)
    if len(columns) > 3:
        raise ScenarioError(f"{cells.source}: {len(columns)} columns without names; the first row must name them.")
    if len(columns) == 2 and kind in {"gradients", "limits", "curves"}:
        guess: tuple[str | None, ...] = (columns[0], None, columns[1])
    else:
        guess = (*columns, None, None)[:3]
    begin, end, value = (named.get(role) or column for role, column in zip(ROLES, guess, strict=False))
    return begin, end, value


def _directions(cells: CellTable) -> str | None:
    """Return the column that says of each row whether it falls, rises or is level."""
    for column in cells.header:
        texts = [direction_word(cell) for _, cell in cells.column(column) if cell != ""]
        if texts and all(text.startswith((*FALLS, *RISES, *IS_LEVEL)) for text in texts):
            return column
    return None


def direction_word(cell: Cell) -> str:
    """Return a cell of a column of directions in small letters without accents."""
    return _words(cell) if isinstance(cell, str) else ""


def _is_called(column: str, name: str) -> bool:
    return _words(column, with_unit=False) == name


def _has_word(column: str, name: str) -> bool:
    return f" {name} " in f" {_words(column, with_unit=False)} "


def _words(text: str, with_unit: bool = True) -> str:
    """Return a column's name in small letters without accents and signs, and if asked without its unit."""
    if not with_unit:
        text = " ".join(name_tokens(text)) or BRACKETS.sub(" ", text)
    return " ".join(re.sub(r"[\W_]+", " ", plain(text)).split())
