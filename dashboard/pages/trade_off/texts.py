"""Numbers and the table of the trade-off."""

from collections.abc import Sequence

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup
from railjoule.dashboard.pages.trade_off.compute import EnocPoint, TradeOff
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.runs import Runs

HINT = "Tick strategies in the list of strategies to add them."
STEPS_S = (-60, -30, -10, 0, 10, 30, 60, 120)
"""Changes of the travel time in the table of least energies."""
LEAST_RAMP_DIFFERENCE_S = 0.05
"""Two acceleration times that are closer read the same in tenths."""


def trade_off_figures(trade_off: TradeOff, best: Trajectory, enoc: EnocPoint | None) -> list[str]:
    """Return the optimum of the present time, and how its energy changes with that time.

    Parameters
    ----------
    trade_off : TradeOff
    best : Trajectory
        The optimum of the present travel time.
    enoc : EnocPoint or None
        ENOC's run in the same time.
    """
    asked, waiting = comparisons.time_asked(best), comparisons.waiting_words(best)
    detail = f"{asked}: {waiting}" if waiting else asked or f"for {words.distance(best.distance_m)} km"
    if enoc is not None:
        detail = f"ENOC {words.energy(enoc.energy_kwh)} kWh, {comparisons.above(enoc.energy_kwh, best.energy_kwh)}"
    optimum = "Optimum" if best.is_proven else words.strategy(best.strategy)
    return [
        parts.figure(
            f"{optimum} at {words.time(best.travel_time_s)} s",
            words.energy(best.energy_kwh),
            "kWh",
            detail,
            "main",
            term="Energy from the supply",
        ),
        parts.price_figure(best, best),
        _changed(trade_off, best, 1.1, "10 % more time"),
        _changed(trade_off, best, 0.9, "10 % less time"),
    ]


def _changed(trade_off: TradeOff, best: Trajectory, factor: float, label: str) -> Markup:
    """Return the change of the minimum energy in a multiple of the present time."""
    time = factor * best.travel_time_s
    energy_kwh = _energy_kwh(trade_off, best, time)
    if time < trade_off.frontier.shortest_travel_time_s:
        value, unit, detail = words.UNKNOWN, "", f"{words.time(time)} s is too short"
    elif not np.isfinite(energy_kwh):
        value, unit, detail = words.UNKNOWN, "", f"not known in {words.time(time)} s"
    else:
        value, unit = comparisons.above(energy_kwh, best.energy_kwh)
        detail = f"{words.energy(energy_kwh)} kWh at {words.time(time)} s"
    return parts.figure(label, value, unit, detail, term="Change of time")


def _energy_kwh(trade_off: TradeOff, best: Trajectory, time_s: float) -> float:
    """Return the minimum energy in another time [kWh]; NaN beyond the frontier."""
    frontier = trade_off.frontier
    # the frontier's mesh may be coarser than that of the run, so only its differences count
    return best.energy_kwh + frontier.energy_kwh_at(time_s) - frontier.energy_kwh_at(best.travel_time_s)


def times_table(trade_off: TradeOff, best: Trajectory) -> Markup:
    """Return the minimum energy in some seconds less and more than the present time."""
    rows: list[tuple[Sequence[str], bool]] = []
    for step_s in STEPS_S:
        time = best.travel_time_s + step_s
        energy_kwh = _energy_kwh(trade_off, best, time)
        more_kwh = energy_kwh - best.energy_kwh
        if step_s == 0 or np.isfinite(energy_kwh):
            share = comparisons.above(energy_kwh, best.energy_kwh).cell
            each = words.number(-1e3 * more_kwh / step_s, 0) if step_s else ""
            shown = words.signed(step_s, 0) if step_s else "now"
            cells = (shown, words.time(time), words.energy(energy_kwh), words.energy_difference(more_kwh), share, each)
            rows.append((cells, step_s == 0))
    head = ("Change, s", "s", "kWh", "vs now, kWh", "vs now, %", "Wh per second")
    return parts.table("Least energy by travel time", head, rows)


def runs_table(trade_off: TradeOff, runs: Runs, enoc: EnocPoint | None) -> Markup:
    """Return the known runs of the scenario, compared as in the list of strategies, and ENOC's by its closed form.

    Parameters
    ----------
    trade_off : TradeOff
    runs : Runs
    enoc : EnocPoint or None
        ENOC's run in the present time, with the acceleration time that is set.
    """
    best, ramps = runs.best, enoc is not None
    rows = []
    for name, run in runs.runs.items():
        if name != "enoc" or not ramps:
            cells = _cells(name, words.strategy(name), run.energy_kwh, comparisons.in_time_asked(run))
            cells += words.time(run.travel_time_s), words.number(run.max_speed_kmh)
            rows.append(((*cells, *([words.UNKNOWN] if ramps else [])), run is best))
    if enoc is not None:
        time = enoc.travel_time_s
        least = trade_off.enoc_point(time)
        assert least is not None
        points = {"ENOC, best ramp": least}
        if abs(enoc.acceleration_time_s - least.acceleration_time_s) > LEAST_RAMP_DIFFERENCE_S:
            points["ENOC, ramp as set"] = enoc
        for printed_time, ramp, energy_kwh in zip(*trade_off.printed_points(), strict=True):
            point = trade_off.enoc_point(time, float(ramp))
            if abs(printed_time - time) < comparisons.OTHER_TIME_S and point is not None:
                points["ENOC as printed"] = EnocPoint(time, float(ramp), float(energy_kwh), point.max_speed_kmh)
        for name, point in points.items():
            more = comparisons.above(point.energy_kwh, best.energy_kwh).cell
            cells = _cells("enoc", name, point.energy_kwh, more)
            speed, ramp_s = words.number(point.max_speed_kmh), words.time(point.acceleration_time_s)
            rows.append(((*cells, words.time(time), speed, ramp_s), False))
    above = f"vs {comparisons.reference_name(runs.is_proven)}, %"
    header = ("Strategy", "kWh", above, "s", "km/h", *(["ramp, s"] if ramps else []))
    table = parts.table(f"Strategies at {words.time(runs.scenario.travel_time_s)} s", header, rows)
    is_complete = STRATEGIES.keys() <= {*runs.runs, *runs.refused}
    return table + parts.note_paragraphs([] if is_complete else [HINT])


def _cells(token: str, name: str, energy_kwh: float, above: str) -> tuple[str, ...]:
    return parts.swatch(token) + name, words.energy(energy_kwh), above
