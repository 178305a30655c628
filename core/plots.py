"""Figures of runs and frontiers with matplotlib, for notebooks and papers."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.errors import RailjouleError
from railjoule.core.strategy import GREY, STRATEGIES
from railjoule.core.units import MS_PER_KMH

if TYPE_CHECKING:
    from railjoule.core.studies import Frontier
    from railjoule.core.trajectory import Trajectory

COAST_ALPHA = 0.12


def plot_run(run: "Trajectory", axes: Any = None) -> Any:
    """Draw the speed of a run over distance, with the permitted speed, and coasting shaded.

    Parameters
    ----------
    run : Trajectory
        The run.
    axes : matplotlib Axes, optional
        Axes to draw on; by default those of a new figure.

    Returns
    -------
    axes : matplotlib Axes
        For titles, further lines and `axes.figure.savefig`.

    Raises
    ------
    RailjouleError
        If matplotlib is not installed.
    """
    axes = plot_speeds([run], axes)
    axes.step(run.position_m[1:], run.run_data.limit_ms / MS_PER_KMH, where="pre", color="0.6", lw=1, label="limit")
    for phase in run.phases:
        if phase.phase == "coast":
            axes.axvspan(phase.start_m, phase.end_m, color="0.5", alpha=COAST_ALPHA, lw=0)
    return _finished(axes)


def plot_speeds(runs: Sequence["Trajectory"], axes: Any = None) -> Any:
    """Draw the speeds of several runs over distance; arguments, result and errors as in `plot_run`.

    Runs of several scenarios have colours by turns, and the titles of their scenarios in the legend.
    """
    axes = axes if axes is not None else _new_axes()
    of_several = len({id(run.scenario) for run in runs}) > 1
    for run in runs:
        strategy = STRATEGIES.get(run.strategy)
        colour: str | None
        colour, label = (strategy.colour[0], strategy.label) if strategy else (GREY[0], run.strategy)
        if of_several:
            colour, label = None, f"{run.scenario.title or 'Untitled scenario'}: {label}"
        axes.plot(run.position_m, run.speed_ms / MS_PER_KMH, color=colour, label=f"{label}, {run.energy_kwh:.3f} kWh")
    axes.set(xlabel="distance [m]", ylabel="speed [km/h]")
    return _finished(axes)


def plot_frontier(frontier: "Frontier", axes: Any = None) -> Any:
    """Draw energy and its lower bound over travel time; `axes`, result and errors as in `plot_run`."""
    axes = axes if axes is not None else _new_axes()
    strategy = STRATEGIES.get(frontier.strategy)
    colour, label = (strategy.colour[0], strategy.label) if strategy else (GREY[0], frontier.strategy)
    table = frontier.to_dataframe().reset_index()
    axes.plot(table["travel_time_s"], table["energy_kwh"], color=colour, marker=".", label=label)
    if np.any(np.isfinite(table["lower_bound_kwh"])):
        axes.plot(table["travel_time_s"], table["lower_bound_kwh"], color="0.6", ls=":", label="lower bound")
    axes.set(xlabel="travel time [s]", ylabel="energy [kWh]")
    axes.legend()
    return axes


def _finished(axes: Any) -> Any:
    """Return axes of speeds that show all lines and begin at zero, with a legend."""
    axes.relim()
    axes.autoscale()
    axes.set_ylim(bottom=0)
    axes.legend()
    return axes


def _new_axes() -> Any:
    try:
        from matplotlib import pyplot  # noqa: PLC0415  (an extra)
    except ModuleNotFoundError:
        raise RailjouleError("Plots need matplotlib; install it with: pip install 'railjoule[plot]'") from None
    return pyplot.subplots()[1]
