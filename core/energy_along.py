"""The energy balance of a run at each place, for each stretch, and between supply and wheels.

The energy drawn up to a place is kinetic and potential energy there, was lost in resistance and losses, or was fed
back. Work at the wheels, supply energy, kinetic and potential energy are computed from the run; resistance and losses
complete the balances of train and drive, so that both end at the sums of `Trajectory.energy`.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.energy import Energy
from railjoule.core.phases import Phase
from railjoule.core.physics.resistance import gradient_force_n
from railjoule.core.trajectory import Trajectory

STRETCH_ENERGIES = ("motion_j", "height_j", "resistance_j", "losses_j", "returned_j", "drawn_j")
BRAKES = ("brake_resistors", "friction_brakes")
"""Losses outside the drive."""


@dataclass(frozen=True, eq=False)
class EnergyAlong:
    """The energy of a run up to each of its nodes [J]: arrays of shape (n + 1,).

    At each node, drawn - returned = motion gained + height + resistance + losses. Auxiliaries are excluded, as they do
    not depend on the driving.

    Parameters
    ----------
    position_m : array
        Places of the nodes [m].
    motion_j : array
        Kinetic energy.
    height_j : array
        Potential energy relative to the start.
    resistance_j, losses_j : array
        Losses in running and curve resistance; in drive, brake resistors and friction brakes.
    returned_j, drawn_j : array
        Fed back to the supply; drawn from it for traction.
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
    """Energies of one phase of a run [J].

    Parameters
    ----------
    phase : Phase
        Driving regime with its start and end.
    motion_j, height_j : float
        Difference between its end and its start.
    resistance_j, losses_j, returned_j, drawn_j : float
        As in `EnergyAlong`, only of the stretch.
    """

    phase: Phase
    motion_j: float
    height_j: float
    resistance_j: float
    losses_j: float
    returned_j: float
    drawn_j: float


def energy_along(run: Trajectory) -> EnergyAlong:
    """Return the energies of a run up to each node."""
    length, duration = np.diff(run.position_m), np.diff(run.time_s)
    vehicle = run.scenario.vehicle
    # constant over the whole run, dwells included
    traction_w = run.supply_power_w - run.energy.auxiliary_j / run.travel_time_s
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


def stretches(run: Trajectory) -> tuple[Stretch, ...]:
    """Return the energies of each phase of a run without intermediate stops."""
    along, phases = energy_along(run), run.phases
    ends = [(phase.start_m, phase.end_m) for phase in phases]
    gained = {name: np.diff(np.interp(ends, along.position_m, getattr(along, name)))[:, 0] for name in STRETCH_ENERGIES}
    return tuple(
        Stretch(phase, **{name: float(values[k]) for name, values in gained.items()}) for k, phase in enumerate(phases)
    )


def _so_far(of_cells: FloatArray) -> FloatArray:
    """Return the sum over the cells before each node."""
    return np.append(0.0, np.cumsum(of_cells))


@dataclass(frozen=True)
class EnergyFlow:
    """The energies of a run, with the work at the wheels [J].

    Parameters
    ----------
    energy : Energy
        The energies.
    wheel_traction_j : float
        Work of the drive at the wheels.
    wheel_braking_j : float
        Work of the electric brake at the wheels.
    """

    energy: Energy
    wheel_traction_j: float
    wheel_braking_j: float

    @property
    def driving_loss_j(self) -> float:
        """Losses of the drive in traction [J]."""
        return self.energy.traction_j - self.wheel_traction_j

    @property
    def braking_loss_j(self) -> float:
        """Losses of the drive in braking, without brake resistors [J]."""
        return self.wheel_braking_j - self.energy.recuperated_j - self.brake_resistors_j

    @property
    def brake_resistors_j(self) -> float:
        """Dissipated in resistors [J]."""
        return self.energy.losses_j.get("brake_resistors", 0.0)

    @property
    def friction_brakes_j(self) -> float:
        """Dissipated in friction brakes [J]."""
        return self.energy.losses_j.get("friction_brakes", 0.0)

    @property
    def imbalance(self) -> float:
        """Losses of the drive from its input and output minus those of its formulas, over the energy exchanged."""
        drive_j = sum(joules for kind, joules in self.energy.losses_j.items() if kind not in BRAKES)
        moved_j = max(self.energy.traction_j + self.energy.recuperated_j, 1.0)
        # the fields of the motors store energy between the supply and the wheels
        drive_j += self.energy.magnetic_field_j
        return (self.driving_loss_j + self.braking_loss_j - drive_j) / moved_j


def energy_flow(run: Trajectory) -> EnergyFlow:
    """Return the energies of a run with the work at the wheels."""
    # 0 during a dwell
    length = np.diff(run.position_m)
    return EnergyFlow(
        energy=run.energy,
        wheel_traction_j=float(np.sum(run.tractive_effort_n * length)),
        wheel_braking_j=float(np.sum(run.electric_braking_n * length)),
    )
