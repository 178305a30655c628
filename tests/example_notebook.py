"""`python -m tests.example_notebook` runs the example of the page on notebooks, and writes it with its outputs."""

import ast
import json
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

PATH = Path(__file__).parents[1] / "assets" / "docs" / "notebook.ipynb"
CELLS = (
    """\
# Runs in a notebook

`pip install '.[notebook]' jupyterlab` in a checkout of railjoule brings what this notebook needs. Run it to see its
figures: this file contains only a description of each.
""",
    """\
import holoviews as hv

from railjoule.core import load_scenario, solve
from railjoule.dashboard.charts.quantities import ENERGY
from railjoule.dashboard.notebook import compare, to_holoviews

hv.extension("bokeh", inline=True, logo=False)
""",
    """\
## One run

Speed, energy and effort have one distance axis: zoom into one of them, and the others follow.
""",
    """\
scenario = load_scenario("liashenko-ii")
run = solve(scenario)
print(f"{run.energy_kwh:.4f} kWh in {run.travel_time_s:.1f} s")
""",
    """\
to_holoviews(run)
""",
    """\
## Several runs

Energy saved by more time. A click on a name in the legend mutes its line.
""",
    """\
runs = {f"{time_s} s": solve(scenario.replace(**{"timetable.travel_time_s": time_s})) for time_s in (135, 150, 165)}
for name, one in runs.items():
    print(f"{name}: {one.energy_kwh:.4f} kWh")
""",
    """\
compare(runs)
""",
    """\
compare(runs, ENERGY, dark=True)
""",
)
"""Text begins with a heading, anything else is code."""


def executed() -> dict[str, Any]:
    """Run the cells in order, and return the notebook with what they print and return."""
    return {
        "cells": list(_cells({})),
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def _cells(names: dict[str, Any]) -> Iterator[dict[str, Any]]:
    count = 0
    for number, text in enumerate(CELLS, 1):
        cell = {"id": f"cell-{number}", "metadata": {}, "source": text.rstrip("\n").splitlines(keepends=True)}
        if text.startswith("#"):
            yield {"cell_type": "markdown", **cell}
        else:
            count += 1
            yield {"cell_type": "code", "execution_count": count, **cell, "outputs": _outputs(text, names, count)}


def _outputs(code: str, names: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """Run a cell as Jupyter does, which shows the value of its last line if that is an expression."""
    tree, value = ast.parse(code), None
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with redirect_stdout(StringIO()) as printed:
        exec(compile(tree, "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": _lines(printed.getvalue())})
    if value is not None:
        data = {"text/plain": _lines(repr(value))}
        outputs.append({"data": data, "execution_count": count, "metadata": {}, "output_type": "execute_result"})
    return outputs


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


if __name__ == "__main__":
    PATH.parent.mkdir(exist_ok=True)
    PATH.write_text(json.dumps(executed(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
