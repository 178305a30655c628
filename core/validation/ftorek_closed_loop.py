"""Tables 1 and 2 of Ftorek et al. 2025 through the closed loop: the plan, driven by the machines.

The printed energies come out without the copper loss of the current that makes the flux, so each table stands here in
that account, and once with all losses.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.ndimage import median_filter

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.units import J_PER_WH, MS_PER_KMH
from railjoule.core.validation._ftorek_rows import (
    FOLLOWS,
    TABLE_1,
    TABLE_2,
    Printed,
    as_if_heavier,
    printed_row,
)
from railjoule.core.validation.ftorek_runs import closed_loop_run
from railjoule.core.validation.table import Row, Table

FILTERED = "The median over half a second: short switching transients are filtered, as in the paper."
# the paper tells that it filtered and not how; half a second removes the switching of the plan and keeps its peaks
FILTER_S = 0.5
SOURCES = {"eoc": ("EOC as printed", TABLE_1, "Figure 4"), "enoc": ("ENOC", TABLE_2, "Figure 5")}
MAGNETISING = (
    "The copper loss of the current that produces the flux, (3/2) Rs id^2, is part of ours; the printed energies do "
    "not include it."
)
LESS_FLUX = "As before, with the flux of least loss at each torque and speed instead of the rated one."


def closed_loop_tables(scenario: Scenario, paper: dict[str, Any]) -> tuple[Callable[[], Table], ...]:
    """Return what makes the tables of EOC and ENOC through the closed loop, in the paper's account and with all losses.

    Parameters
    ----------
    scenario : Scenario
        The paper's run.
    paper : dict
        Its printed numbers.
    """
    return (
        partial(_in_the_papers_account, scenario, "eoc", paper["table_1"]),
        partial(_in_the_papers_account, scenario, "enoc", paper["table_2"]),
        partial(_with_all_losses, scenario, paper["table_2"]),
    )


def _in_the_papers_account(scenario: Scenario, strategy: str, printed: list[Printed]) -> Table:
    rows: list[Row] = []
    words, place, figure = SOURCES[strategy]
    for entry in printed:
        run = closed_loop_run(scenario, strategy, entry["travel_time_s"])
        # at every sample and not at the end alone, as the largest energy on the way is printed too
        energy = run.energy_by_input_power_j - run.magnetising_so_far_j
        current = _without_spikes(run)
        row, shaft = partial(printed_row, place, entry), run.parts_j["shaft"] / J_PER_WH
        rows += [
            row("max_speed_kmh", float(run.speed_ms.max()) / MS_PER_KMH),
            row("max_current_a", float(current.max()), FILTERED),
            row("min_current_a", float(current.min()), FILTERED),
            row("shaft_energy_wh", shaft, as_if_heavier(entry, shaft)),
            row("peak_energy_wh", float(np.max(energy)) / J_PER_WH, FOLLOWS),
            row("total_energy_wh", float(energy[-1]) / J_PER_WH, FOLLOWS),
        ]
    title = f"{words} driven in closed loop, without the magnetising loss"
    return Table(title, tuple(rows), f"{place}, {figure}")


def _without_spikes(run: FieldOrientedRun) -> FloatArray:
    """Return the torque current at the samples of a run, short transients filtered [A]."""
    step = float(np.median(np.diff(run.time_s)))
    # odd, so that the median is centred; a mean would smear a jump instead of removing a spike
    filtered: FloatArray = median_filter(run.torque_current_a, size=2 * round(FILTER_S / step / 2) + 1)
    return filtered


def _with_all_losses(scenario: Scenario, printed: list[Printed]) -> Table:
    rows: list[Row] = []
    for entry in printed:
        run = closed_loop_run(scenario, "enoc", entry["travel_time_s"])
        less_flux = closed_loop_run(scenario, "enoc", entry["travel_time_s"], "least_loss")
        row = partial(printed_row, TABLE_2, entry, "total_energy_wh")
        rows += [
            row(float(run.energy_by_input_power_j[-1]) / J_PER_WH, MAGNETISING, by="input power"),
            row(float(run.energy_by_parts_j[-1]) / J_PER_WH, MAGNETISING, by="parts"),
            row(float(less_flux.energy_by_input_power_j[-1]) / J_PER_WH, LESS_FLUX, by="least-loss flux"),
        ]
    return Table("ENOC driven in closed loop, with all losses", tuple(rows), TABLE_2)
