"""A run whose account says that it needs another energy: for what happens where a strategy beats the optimum."""

from dataclasses import replace

from railjoule.core import Trajectory


def needing(run: Trajectory, net_j: float) -> Trajectory:
    """Return a run that is said to need so much energy [J], by the work of its motors."""
    return replace(run, energy=replace(run.energy, traction_j=run.energy.traction_j + net_j - run.energy.net_j))
