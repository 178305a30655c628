"""core/NOMENCLATURE.md names every public argument and field of the core, and nothing else."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

CORE = Path(__file__).parents[2] / "core"

UNITS = {
    "_a": "A",
    "_h": "H",
    "_hz": "Hz",
    "_j": "J",
    "_kg": "kg",
    "_km": "km",
    "_kmh": "km/h",
    "_kn": "kN",
    "_kw": "kW",
    "_kwh": "kWh",
    "_m": "m",
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


class Use(NamedTuple):
    """A name, and the file and class or function that has it."""

    name: str
    place: str


def uses() -> list[Use]:
    """Return every argument of public functions and methods, and every declared field of public classes."""
    return [
        Use(name, f"{path.relative_to(CORE).as_posix()}: {owner}")
        for path in sorted(CORE.rglob("*.py"))
        for name, owner in _names(ast.parse(path.read_text(encoding="utf-8")).body)
        if not name.startswith("_")
    ]


def _names(body: list[ast.stmt], inside: str = "") -> Iterator[tuple[str, str]]:
    for node in body:
        if isinstance(node, ast.FunctionDef) and (not node.name.startswith("_") or node.name == "__init__"):
            arguments = node.args
            for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
                if not (inside and argument.arg in ("self", "cls")):
                    yield argument.arg, inside + node.name
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from _names(node.body, f"{node.name}.")
        elif inside and isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id, inside.removesuffix(".")


def tables() -> dict[str, dict[str, list[str]]]:
    """Return the rows of each table of the file by heading and name."""
    found: dict[str, dict[str, list[str]]] = {}
    heading = ""
    for line in (CORE / "NOMENCLATURE.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            heading = line.removeprefix("## ")
            found[heading] = {}
        elif line.startswith("| `"):
            name, *cells = (cell.strip() for cell in line.strip("|").split("|"))
            assert name.strip("`") not in found[heading], f"{name} stands twice under {heading!r}"
            found[heading][name.strip("`")] = cells
    return found


USES = uses()
TABLES = tables()
QUANTITIES, OTHERS, *_ = TABLES.values()
INSIDE = {
    "drive": TABLES["Inside the drives"],
    "physics": TABLES["Inside the physics"],
    "interior_point": TABLES["Inside the interior-point method"],
    "dynamic_programming": TABLES["Inside the dynamic programming"],
    "check": TABLES["Inside the check"],
    "simulate": TABLES["Inside the simulations"],
}
"""The names that one package alone uses."""


def test_every_name_is_in_the_file():
    unknown = {
        use.name: use.place
        for use in USES
        if use.name not in QUANTITIES
        and use.name not in OTHERS
        and use.name not in INSIDE.get(use.place.split("/")[0], ())
    }
    assert not unknown, f"not in core/NOMENCLATURE.md: {unknown}"


def test_every_row_is_used():
    names = {use.name for use in USES}
    unused = sorted({*QUANTITIES, *OTHERS} - names)
    for package, rows in INSIDE.items():
        unused += sorted(rows.keys() - {use.name for use in USES if use.place.startswith(f"{package}/")})
    assert not unused, f"no code uses these rows of core/NOMENCLATURE.md: {unused}"


def test_a_quantity_is_not_listed_as_none():
    assert not QUANTITIES.keys() & OTHERS.keys()


@pytest.mark.parametrize("heading", TABLES)
def test_rows_are_sorted_and_complete(heading):
    rows = TABLES[heading]
    assert list(rows) == sorted(rows)
    assert {len(cells) for cells in rows.values()} == {len(next(iter(rows.values())))}
    assert all(cell for cells in rows.values() for cell in cells)


def test_names_tell_their_units():
    for name, (*_, unit, _meaning) in QUANTITIES.items():
        endings = [ending for ending in UNITS if name.endswith(ending)]
        told = UNITS[max(endings, key=len)] if endings else "1"
        assert (unit == told) != (name in WITHOUT_UNIT), f"{name} is in {unit}"


def test_a_new_name_would_be_found():
    body = ast.parse("class Train:\n    mass_t: float\n    def pull(self, effort_kN, *, _hidden=0): ...\n").body
    assert [name for name, _ in _names(body)] == ["mass_t", "effort_kN", "_hidden"]
