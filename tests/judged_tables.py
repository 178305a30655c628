"""The tables of `tests.judge_bounds`: gaps by drive, and rivals below their bounds."""

from collections.abc import Iterator
from typing import Any

import numpy as np

Row = dict[str, Any]

SMOOTH = ("constant_efficiency", "copper_loss")
"""Drives without idle losses."""
BELOW_SHARE = 1e-6
"""A train that undercuts a bound by more than this share refutes it."""
MOST_LINES = 20
"""So many rivals are listed where more are counted."""


def refuting(row: Row) -> Iterator[tuple[str, float]]:
    """Yield the driven trains that refute a bound, along which plan, and by which share."""
    plans = [(f"{rival['strategy']} at {rival['mesh_m']:.3g} m", rival["driven"]) for rival in row.get("rivals", ())]
    for name, train in [("optimal over the finest mesh", row.get("driven")), *plans]:
        if train is not None and train["below"] > BELOW_SHARE:
            yield name, train["below"]


def table(rows: list[Row]) -> str:
    """Return the summary by drive, and the rivals below their bounds."""
    solved = [row for row in rows if row["status"] == "solved" and row["gap"] is not None]
    kinds = sorted({row["model"] for row in solved})
    lines = [f"{len(rows)} scenarios: {', '.join(_statuses(rows))}", "", *_gap_lines(solved, kinds)]
    return "\n".join([*lines, "", *_rival_lines(solved)])


def _statuses(rows: list[Row]) -> list[str]:
    statuses = [row["status"] for row in rows]
    return [f"{statuses.count(status)} {status}" for status in sorted(set(statuses))]


def _gap_lines(rows: list[Row], kinds: list[str]) -> Iterator[str]:
    yield "| drive | count | median gap [%] | 90 % | 99 % | worst | <= 0.05 % | <= 0.5 % | cells | time [ms] | worst |"
    yield "| --- " * 11 + "|"
    groups = [(kind, [row for row in rows if row.get("model") == kind]) for kind in kinds]
    smooth = [row for row in rows if row.get("model") in SMOOTH]
    for kind, mine in [*groups, ("smooth drives", smooth), ("all", rows)]:
        gaps = np.array([row["gap"] for row in mine if row.get("gap") is not None])
        if not len(gaps):
            continue
        quantiles = " | ".join(f"{100 * np.quantile(gaps, share):.4f}" for share in (0.5, 0.9, 0.99, 1.0))
        shares = " | ".join(f"{100 * np.mean(gaps <= share):.1f} %" for share in (5e-4, 5e-3))
        cells, times = (np.array([row[key] for row in mine if key in row]) for key in ("cells", "seconds"))
        yield (
            f"| {kind} | {len(gaps)} | {quantiles} | {shares} | {np.median(cells):.0f} | "
            f"{1e3 * np.median(times):.1f} | {1e3 * times.max():.0f} |"
        )


def _rival_lines(rows: list[Row]) -> Iterator[str]:
    """Yield the counts of rivals, those below by strategy and mesh, and each that refutes a bound."""
    judged = [(row, rival) for row in rows for rival in row.get("rivals", ())]
    below = [(row, rival) for row, rival in judged if rival["below"] > BELOW_SHARE and not rival["broken"]]
    yield f"runs over cells: {len(judged)}, of them with a broken rule: {sum(bool(r['broken']) for _, r in judged)}"
    yield f"of the others below the bound: {len(below)}, in {len({row['seed'] for row, _ in below})} scenarios"
    finest = {row["seed"]: min(rival["mesh_m"] for rival in row["rivals"]) for row, _ in judged}
    left = [(row, rival) for row, rival in below if rival["mesh_m"] == finest[row["seed"]]]
    yield (
        f"of them over the finest mesh of their scenario: {len(left)}, "
        f"and of these not possible in time for a driven train: {sum(rival['driven'] is None for _, rival in left)}"
    )
    for row, rival in sorted(below, key=lambda pair: -pair[1]["below"])[:MOST_LINES]:
        driven = "not possible in time" if rival["driven"] is None else f"{100 * rival['driven']['below']:+.4f} %"
        yield (
            f"  {row['seed']} {row['model']}: {rival['strategy']} at {rival['mesh_m']:.3g} m by "
            f"{100 * rival['below']:.4f} %, driven {driven}, gap {100 * row['gap']:.4f} %"
        )
    ipopts = [row["ipopt"] for row in rows if row.get("ipopt") is not None and row["ipopt"]["converged"]]
    yield _spread_line("IPOPT over 1 m, above the bound", [-rival["below"] for rival in ipopts])
    yield _spread_line("railjoule over 1 m, above IPOPT", [rival["railjoule_above"] for rival in ipopts])
    trains = [row["driven"] for row in rows if row.get("driven") is not None]
    yield _spread_line("driven trains, above the bound", [-train["below"] for train in trains])
    refuted = [(row["seed"], *rival) for row in rows for rival in refuting(row)]
    covering = sum(row["every_run"] for row in rows)
    yield f"bounds refuted: {len({seed for seed, *_ in refuted})} of {len(rows)}; {covering} are to cover every run"
    for seed, name, share in sorted(refuted, key=lambda found: -found[2])[:MOST_LINES]:
        yield f"  {seed}: driven along {name}, by {100 * share:.4f} %"


def _spread_line(name: str, shares: list[float]) -> str:
    if not shares:
        return f"{name}: none"
    spread = ", ".join(f"{100 * np.quantile(shares, share):.5f} %" for share in (0.0, 0.1, 0.5, 0.9, 1.0))
    return f"{name}: {len(shares)}; least, 10 %, median, 90 %, most {spread}"
