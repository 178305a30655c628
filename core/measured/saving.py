"""What a measured run could have saved: its energy beside the optimum for the same time and the same stops."""

from dataclasses import dataclass

from railjoule.core.errors import InfeasibleLineError, RecordingError, TimetableError
from railjoule.core.measured.run import MeasuredRun
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Saving:
    """A measured run beside the best one in its time.

    Parameters
    ----------
    run : MeasuredRun
        As it was driven.
    optimum : Trajectory
        The best run over the same part of the line, with the same stops, dwells, total time and speeds at the ends.
    """

    run: MeasuredRun
    optimum: Trajectory

    @property
    def possible_kwh(self) -> float:
        """What the optimum needs less than the modelled run [kWh]; both by the same model.

        A run at the optimum may come out a per cent below it: between two samples it may have done what cost more.
        """
        return self.run.modelled.energy_kwh - self.optimum.energy_kwh

    @property
    def at_most_kwh(self) -> float | None:
        """What no run in this time can exceed: the modelled run less the proven bound [kWh]."""
        bound = self.optimum.lower_bound_kwh
        return None if bound is None else self.run.modelled.energy_kwh - bound


def possible_saving(run: MeasuredRun) -> Saving:
    """Return what a measured run could have saved.

    Raises
    ------
    RecordingError
        If the scenario's train cannot keep the measured time: then it is another train, or its limits are others.
    RailjouleError
        As `railjoule.core.solve`.
    """
    try:
        return Saving(run, solve(run.scenario, "optimal"))
    except TimetableError as error:
        raise RecordingError(
            f"{run.recording.name}: the run takes {error.travel_time_s:.4g} s without its stops, but the scenario's "
            f"train needs at least {error.shortest_time_s:.4g} s: its efforts or the line's limits are not those "
            "of this run."
        ) from None
    except InfeasibleLineError as error:
        raise RecordingError(f"{run.recording.name}: the scenario's train cannot drive this run. {error}") from None
