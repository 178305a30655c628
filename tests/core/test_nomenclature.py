"""core/NOMENCLATURE.md tells the papers' symbols of quantities; docstrings tell all other arguments and fields."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from name_units import WITHOUT_UNIT, unit_of

CORE = Path(__file__).parents[2] / "core"
DASH = "\u2014"
"""Stands where a paper has no symbol."""

Owner = ast.ClassDef | ast.FunctionDef


def owners() -> list[tuple[str, Owner]]:
    """Return every public class and function of the core with its file, those inside of public classes included."""
    return [
        (path.relative_to(CORE).as_posix(), owner)
        for path in sorted(CORE.rglob("*.py"))
        for owner in _owners(ast.parse(path.read_text(encoding="utf-8")).body)
    ]


def _owners(body: list[ast.stmt]) -> Iterator[Owner]:
    for node in body:
        if isinstance(node, Owner) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from _owners(node.body)


def names_of(owner: Owner) -> list[str]:
    """Return the public arguments of a function, the declared fields of a class, or else those of its __init__."""
    if isinstance(owner, ast.FunctionDef):
        arguments = owner.args
        every = (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
        names = [argument.arg for argument in every if argument.arg not in ("self", "cls")]
    else:
        fields = [node.target for node in owner.body if isinstance(node, ast.AnnAssign)]
        names = [field.id for field in fields if isinstance(field, ast.Name)]
        starts = [node for node in owner.body if isinstance(node, ast.FunctionDef) and node.name == "__init__"]
        names = names or [name for start in starts for name in names_of(start)]
    return [name for name in names if not name.startswith("_")]


def listed_parameters(owner: Owner) -> list[str]:
    """Return the names that the section of parameters in a docstring lists; none where it has no such section."""
    section = re.search(r"Parameters\n-+\n(.*?)(?=\n\w+\n---|\Z)", ast.get_docstring(owner) or "", re.DOTALL)
    heads = [line.split(":")[0] for line in section[1].splitlines() if line[:1].strip()] if section else []
    return [name for head in heads for name in re.findall(r"(?<!\*)\b\w+", head)]


def rows() -> dict[str, list[str]]:
    """Return the cells of each row of the file by name."""
    found: dict[str, list[str]] = {}
    for line in (CORE / "NOMENCLATURE.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("| `"):
            name, *cells = (cell.strip() for cell in line.strip("|").split("|"))
            assert name.strip("`") not in found, f"{name} stands twice"
            found[name.strip("`")] = cells
    return found


OWNERS = owners()
ROWS = rows()


def test_every_row_is_used():
    used = {name for _, owner in OWNERS for name in names_of(owner)}
    unused = sorted(ROWS.keys() - used)
    assert not unused, f"no code uses these rows of core/NOMENCLATURE.md: {unused}"


def test_rows_are_sorted_and_complete():
    assert list(ROWS) == sorted(ROWS)
    for name, cells in ROWS.items():
        *symbols, _unit, _meaning = cells
        assert len(symbols) == 4, f"{name} does not have a cell for each paper"
        assert all(cells), f"{name} has an empty cell"
        assert any(symbol != DASH for symbol in symbols), f"{name} has no symbol in any paper"


def test_names_tell_their_units():
    for name, (*_, unit, _meaning) in ROWS.items():
        assert (unit == unit_of(name)) != (name in WITHOUT_UNIT), f"{name} is in {unit}"


@pytest.mark.parametrize("folder", sorted({place.split("/")[0] for place, _ in OWNERS}))
def test_a_docstring_that_lists_parameters_lists_them_all(folder):
    differing = {
        f"{place}: {owner.name}": sorted(set(names_of(owner)) ^ set(listed))
        for place, owner in OWNERS
        if place.split("/")[0] == folder
        and (listed := listed_parameters(owner))
        and set(listed) != set(names_of(owner))
    }
    assert not differing, f"these docstrings and signatures differ: {differing}"


def test_a_parameter_that_is_left_out_would_be_found():
    (owner,) = ast.parse(
        'def pull(train, effort_n, **details):\n    """Pull.\n\n    Parameters\n    ----------\n    effort_n : float\n'
        '        Effort [N].\n    **details\n        More.\n\n    Raises\n    ------\n    ValueError\n    """\n'
    ).body
    assert isinstance(owner, ast.FunctionDef)
    assert names_of(owner) == ["train", "effort_n"]
    assert listed_parameters(owner) == ["effort_n"]
