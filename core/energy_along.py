"""Where a run's energy is and has gone, place by place and stretch by stretch: the account of a run, followed along it.

What the line has given up to a place is motion and height there, or has gone into resistance and losses, or was given
back. Work at the wheels, line energy, motion and height are those of the run; resistance and losses are what closes the
account of train and drive, so that both end at the sums of `Trajectory.energy`.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.phases import Phase
from railjoule.core.physics.resistance import gradient_force_n
from railjoule.core.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class EnergyAlong:
    """The energy of a run up to each of its nodes [J]: arrays of shape (n + 1,).

    The account closes at each of them: drawn - returned = motion gained + height + resistance + losses. Auxiliaries
    are apart, as they run whatever the driver does.

    Parameters
    ----------
    position_m : array
        Places of the nodes [m].
    motion_j : array
        Kinetic energy that the train has there.
    height_j : array
        Potential energy beyond that at the start; negative below it.
    resistance_j, losses_j : array
        Gone into running and curve resistance; into drive, brake resistors and friction brakes.
    returned_j, drawn_j : array
        Given back to the line; taken from it to drive.
    """

    position_m: FloatArray
    motion_j: FloatArray
    height_j: FloatArray
    resistance_j: FloatArray
    losses_j: FloatArray
    returned_j: FloatArray
    drawn_j: FloatArray


@dataclass(frozen=True)
class Stretch:
    """What one phase of a run does to the energy, and what its time is worth [J].

    Parameters
    ----------
    phase : Phase
        What the driver does, from where to where.
    motion_j, height_j : float
        What the train has more at its end than at its start.
    resistance_j, losses_j, returned_j, drawn_j : float
        As in `EnergyAlong`, of the stretch alone.
    time_worth_j : float or None
        Its time at the price of a second, where the run has one: so much would be saved if the timetable allowed the
        same time more at that price.
    """

    phase: Phase
    motion_j: float
    height_j: float
    resistance_j: float
    losses_j: float
    returned_j: float
    drawn_j: float
    time_worth_j: float | None


def energy_along(run: Trajectory) -> EnergyAlong:
    """Return where a run's energy is and has gone at each of its nodes."""
    length, duration = np.diff(run.position_m), np.diff(run.time_s)
    vehicle = run.scenario.vehicle
    # constant over the whole run, dwells included
    traction_w = run.line_power_w - run.energy.auxiliary_j / run.travel_time_s
    drawn, returned = (_so_far(np.maximum(sign * traction_w, 0.0) * duration) for sign in (1, -1))
    motion = 0.5 * vehicle.total_inertia_kg * run.speed_ms**2
    height = _so_far(gradient_force_n(vehicle, run.gradient_permille) * length)
    driven = _so_far((run.tractive_effort_n - run.electric_braking_n) * length)
    rubbed = _so_far(run.friction_braking_n * length)
    return EnergyAlong(
        position_m=run.position_m,
        motion_j=frozen_array(motion),
        height_j=frozen_array(height),
        resistance_j=frozen_array(driven - rubbed - (motion - motion[0]) - height),
        losses_j=frozen_array(drawn - returned - driven + rubbed),
        returned_j=frozen_array(returned),
        drawn_j=frozen_array(drawn),
    )


def stretches(run: Trajectory, price_of_time_w: float | None = None) -> tuple[Stretch, ...]:
    """Return what each phase of a run does to the energy.

    Parameters
    ----------
    run : Trajectory
        The run, without stops on the way.
    price_of_time_w : float, optional
        The price of a second, where it is not the run's own [J/s].
    """
    along = energy_along(run)
    price = run.price_of_time_w if price_of_time_w is None else price_of_time_w

    def gained(energy: FloatArray, phase: Phase) -> float:
        start, end = np.interp([phase.start_m, phase.end_m], along.position_m, energy)
        return float(end - start)

    return tuple(
        Stretch(
            phase=phase,
            motion_j=gained(along.motion_j, phase),
            height_j=gained(along.height_j, phase),
            resistance_j=gained(along.resistance_j, phase),
            losses_j=gained(along.losses_j, phase),
            returned_j=gained(along.returned_j, phase),
            drawn_j=gained(along.drawn_j, phase),
            time_worth_j=None if price is None else price * (phase.end_s - phase.start_s),
        )
        for phase in run.phases
    )


def _so_far(of_cells: FloatArray) -> FloatArray:
    """Return the sum of what stands in the cells before each node."""
    return np.append(0.0, np.cumsum(of_cells))
