"""Time, distance and energy of starting, coasting and braking, tabulated against speed.

Over speed each is an integral of dv / a, of v dv / a and of P dv / a, so no time steps are needed: Gauss points between
knots, a knot wherever a limit of effort has a corner, and cubics through the knots with their exact derivatives.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array
from railjoule.core.drive import Drive, make_drive
from railjoule.core.drive.induction.drive import InductionDrive
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion.permitted_speed import curve_steps
from railjoule.core.physics.adhesion import adhesion_coefficient
from railjoule.core.physics.braking import electric_efforts
from railjoule.core.physics.resistance import resistance_coefficients, running_resistance
from railjoule.core.physics.vehicle_limit import limit_corners_ms, vehicle_limit_n
from railjoule.core.scenario import Vehicle
from railjoule.core.units import N_PER_KN

# Speed from knot to knot of the cubics: half or double of it changes 2 ppm of a run's energy
KNOT_STEP_MS = 0.25
# A train with fewer knots than this has cubics too long for its curve of resistance
MIN_KNOTS = 8
# A start goes no further than to where the train still gains this much: beyond, 1 / a grows without bound, and a train
# that needs more than two minutes for a km/h does not use it to save energy. 1e-3 to 2e-2 give the same runs
MIN_ACCELERATION_MS2 = 2e-3
# A brake that has less than this share of the tractive effort is none: the effort of a missing one is not exactly zero
MIN_BRAKING_SHARE = 1e-6
# Distances from the tables are good to a millionth or two; a curve of braking must not be passed by their error
UNDER_CURVE = 1e-5
"""A train brakes by this share less than its braking curve."""
# A corner closer than this to a knot takes its place: a piece without length would divide by nothing
SAME_KNOT_MS = 1e-3
# leaves 2e-13 m/s of the step between two knots
HALVINGS = 40
# four points integrate polynomials up to the seventh degree: one step of a smooth 1 / a to twelve digits
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True, eq=False)
class PhaseModel:
    """A train on a line without changes, and the tables of its phases; efforts in N, speeds in m/s.

    A table has the rows speed, time, distance, line energy, and the derivatives of the last three by speed. The
    energy has no auxiliaries, which a given time fixes.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle with its load.
    drive : Drive
        Its loss model.
    line_force_n : float
        Force of the line against the train [N].
    top_speed_ms : float
        Largest speed of vehicle and line [m/s].
    holds_current : bool
        Whether a start holds its current at all speeds, as printed by Rawicki, where less of it would give more effort.
    head_wind_ms : float
        Wind against the train [m/s].
    driven_n : float
        Adhesive weight of the driven axles [N], infinite where adhesion sets no limit.
    """

    vehicle: Vehicle
    drive: Drive
    line_force_n: float
    top_speed_ms: float
    holds_current: bool = False
    head_wind_ms: float = 0.0
    driven_n: float = np.inf

    @property
    def inertia_kg(self) -> float:
        """Mass that resists acceleration [kg]."""
        return self.vehicle.total_inertia_kg

    def resistance_n(self, speed_ms: FloatArray, speed2: FloatArray | None = None) -> FloatArray:
        """Return the resistance at speeds [N], or at mean speeds of cells and their mean squares."""
        squares = np.square(speed_ms) if speed2 is None else speed2
        return running_resistance(*self.coefficients, np.asarray(speed_ms), squares)

    @cached_property
    def coefficients(self) -> tuple[float, float, float]:
        """Constant, linear and quadratic coefficient of the resistance, line included [N, N s/m, N s2/m2]."""
        constant, linear, quadratic = resistance_coefficients(self.vehicle, self.head_wind_ms)
        return constant + self.line_force_n, linear, quadratic

    def starting_effort_n(self, speed_ms: FloatArray, starting_current_a: float | None = None) -> FloatArray:
        """Return the effort of a start [N], full or with a current [A]; shape as the speeds'."""
        if starting_current_a is None:
            by_drive = self.drive.effort_limit_n(speed_ms)
        else:
            by_drive = self.drive.effort_at_current_n(starting_current_a, speed_ms)
        effort = np.minimum(vehicle_limit_n(self.vehicle, speed_ms, driven_n=self.driven_n), by_drive)
        limit_ms2 = self.vehicle.traction.max_acceleration_ms2
        if limit_ms2 is None:
            return effort
        return np.minimum(effort, self.resistance_n(speed_ms) + limit_ms2 * self.inertia_kg)

    def braking_effort_n(self, speed_ms: FloatArray) -> FloatArray:
        """Return the effort of the electric brake [N], or of the friction brakes where there is none."""
        if self.brakes_with_friction:
            effort = np.full(np.shape(speed_ms), N_PER_KN * self.vehicle.braking.friction_effort_kn)
        else:
            by_vehicle = vehicle_limit_n(self.vehicle, speed_ms, True, self.driven_n)
            effort = np.minimum(by_vehicle, self.drive.effort_limit_n(speed_ms, braking=True))
        limit_ms2, _ = self._max_deceleration
        effort = np.minimum(effort, limit_ms2 * self.inertia_kg - self.resistance_n(speed_ms))
        return np.asarray(np.maximum(effort, 0.0))

    def table(self, phase: str, starting_current_a: float | None = None) -> FloatArray:
        """Return the table of a start, full or with a current [A], of coasting or of braking; shape (7, k)."""
        if phase == "start":
            return _start_table(self, starting_current_a)
        return self.coasting if phase == "coast" else self.braking

    @cached_property
    def brakes_with_friction(self) -> bool:
        """Whether the vehicle has no electric brake."""
        return self.vehicle.braking.max_effort_kn == 0

    def braking_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the line power while braking [W]; friction brakes take over where the drive would draw power."""
        if self.brakes_with_friction:
            return np.zeros(np.shape(speed_ms))
        friction_n = N_PER_KN * self.vehicle.braking.friction_effort_kn
        electric = electric_efforts(self.drive.kind, self.drive.parameters, effort_n, speed_ms, effort_n, friction_n)
        return self.drive.supply_power_w(-electric, speed_ms)

    def start(self, starting_current_a: float | None) -> FloatArray:
        """Return the table of a start from rest; shape (7, k)."""

        def motion(speed: FloatArray) -> tuple[FloatArray, FloatArray]:
            effort, power = self.starting_law(speed, starting_current_a)
            return (effort - self.resistance_n(speed)) / self.inertia_kg, power

        # The integrands have a corner where the effort has one: between knots they must be smooth.
        knots = self._knots(self._corner_ms(starting_current_a, braking=False))
        slow = np.flatnonzero(motion(knots)[0] < MIN_ACCELERATION_MS2)
        count = int(slow[0]) if len(slow) else len(knots)
        if count < 2:
            raise StrategyRefusedError("needs a train that its drive can start.")
        return _table(motion, knots[:count])

    def starting_law(self, speed_ms: FloatArray, starting_current_a: float | None) -> tuple[FloatArray, FloatArray]:
        """Return effort [N] and line power [W] of a start, full or with a current [A]."""
        # full current is not always the most effort: beyond the pull-out the machine pulls more with less
        if self.holds_current and isinstance(self.drive, InductionDrive):
            current = self.drive.starting_current_a if starting_current_a is None else starting_current_a
            return self.drive.full_current_start(speed_ms, current)
        effort = self.starting_effort_n(speed_ms, starting_current_a)
        return effort, self.drive.supply_power_w(effort, speed_ms)

    @cached_property
    def coasting(self) -> FloatArray:
        """The table of coasting from a speed down to rest; shape (7, k)."""

        def motion(speed: FloatArray) -> tuple[FloatArray, FloatArray]:
            return self.resistance_n(speed) / self.inertia_kg, np.zeros(speed.shape)

        knots = self._knots()
        if np.min(self.resistance_n(knots)) <= 0:
            raise StrategyRefusedError("needs a line on which a coasting train loses speed.")
        return _table(motion, knots)

    @cached_property
    def braking(self) -> FloatArray:
        """The table of braking from a speed down to rest; shape (7, k)."""

        def motion(speed: FloatArray) -> tuple[FloatArray, FloatArray]:
            effort = self.braking_effort_n(speed)
            deceleration = (effort + self.resistance_n(speed)) / self.inertia_kg
            return deceleration, self.braking_power_w(effort, speed)

        speeds, (limit_ms2, key) = self._knots(), self._max_deceleration
        effort, largest_n = self.braking_effort_n(speeds), np.max(self.starting_effort_n(speeds))
        if np.min(self.resistance_n(speeds)) >= limit_ms2 * self.inertia_kg:
            raise StrategyRefusedError(f"needs a line on which a coasting train slows down by less than {key}.")
        if not np.isfinite(effort).all() or np.max(effort) <= MIN_BRAKING_SHARE * largest_n:
            raise StrategyRefusedError("needs a brake whose largest effort is given.")
        knots = self._knots(self._corner_ms(None, braking=True), self._drawing_until_ms())
        return _table(motion, knots)

    @cached_property
    def _max_deceleration(self) -> tuple[float, str]:
        """The largest deceleration of braking [m/s2], infinite where there is none, and the key that sets it."""
        max_ms2 = self.vehicle.braking.max_deceleration_ms2
        permitted_ms2 = curve_steps(self.vehicle)[1].min(initial=np.inf)
        if max_ms2 is not None and max_ms2 <= permitted_ms2:
            return max_ms2, f"vehicle.braking.max_deceleration_ms2 = {max_ms2:g} m/s2"
        # of several steps the smallest, which stays under the curve: a table over speed would jump between two of them
        key = f"vehicle.braking.permitted_deceleration = {permitted_ms2:g} m/s2"
        return (1 - UNDER_CURVE) * permitted_ms2, key

    def _drawing_until_ms(self) -> float:
        """Return the speed below which full braking recuperates nothing [m/s]; 0 where there is none.

        Below it resistors take all the drive generates, above it the recuperated share: the power has a corner there.
        """

        def draws(speed_ms: FloatArray | float) -> BoolArray:
            at = np.asarray(speed_ms)
            return self.drive.supply_power_w(-self.braking_effort_n(at), at) >= 0

        knots = self._knots()[1:]
        drawing = np.flatnonzero(draws(knots))
        if self.drive.recuperation_factor == 0 or not len(drawing) or drawing[-1] + 1 >= len(knots):
            return 0.0
        low, high = knots[drawing[-1] : drawing[-1] + 2]
        # below the root the power is zero, which leaves other searches no bracket
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if draws(middle) else (low, middle)
        return float(high)

    def _corner_ms(self, starting_current_a: float | None, braking: bool) -> float:
        """Return the speed at which the effort begins to fall [m/s]; 0 where it does not."""
        if not isinstance(self.drive, InductionDrive):
            return 0.0
        full = self.drive.braking_current_a if braking else self.drive.starting_current_a
        current = full if starting_current_a is None else min(full, starting_current_a)
        return float(self.drive.corner_speed_ms(current, braking))

    def _knots(self, *further_ms: float) -> FloatArray:
        """Return speeds from 0 to the top one, with corners of the vehicle's limits and `further_ms` among them."""
        corners = [*further_ms]
        for limits in (self.vehicle.traction, self.vehicle.braking):
            if limits.max_effort_kn and limits.max_power_kw:
                corners.append(limits.max_power_kw / limits.max_effort_kn)
            corners += limit_corners_ms(limits).tolist()
        corners += self._adhesion_corners_ms()
        inside = [speed for speed in corners if SAME_KNOT_MS < speed < self.top_speed_ms - SAME_KNOT_MS]
        count = max(int(np.ceil(self.top_speed_ms / KNOT_STEP_MS)), MIN_KNOTS)
        uniform = np.linspace(0, self.top_speed_ms, count + 1)
        if inside:
            to_corner = np.min(np.abs(uniform[:, None] - np.array(inside)), axis=1)
            uniform = uniform[to_corner > SAME_KNOT_MS]
        return np.union1d(uniform, inside)

    def _adhesion_corners_ms(self) -> list[float]:
        """Return the speeds at which adhesion begins or ceases to be the lowest limit of the drive [m/s]."""
        if np.isinf(self.driven_n):
            return []
        speeds = np.arange(0.0, self.top_speed_ms, KNOT_STEP_MS)
        corners = []
        for braking in (False, True):

            def excess(speed: FloatArray, braking: bool = braking) -> FloatArray:
                by_vehicle = vehicle_limit_n(self.vehicle, speed, braking)
                by_drive = self.drive.effort_limit_n(np.asarray(speed), braking)
                return np.minimum(by_vehicle, by_drive) - self.driven_n * adhesion_coefficient(speed)

            for turn in np.flatnonzero(np.diff(np.sign(excess(speeds)))):
                corners.append(float(scipy.optimize.brentq(excess, speeds[turn], speeds[turn + 1])))
        return corners


@lru_cache(maxsize=32)
def phase_model(
    vehicle: Vehicle, line_force_n: float, top_speed_ms: float, head_wind_ms: float = 0.0, driven_n: float = np.inf
) -> PhaseModel:
    """Return the model of a vehicle, from a cache."""
    return PhaseModel(vehicle, make_drive(vehicle.drive), line_force_n, top_speed_ms, False, head_wind_ms, driven_n)


@lru_cache(maxsize=128)
def _start_table(model: PhaseModel, starting_current_a: float | None) -> FloatArray:
    """Return the table of a start with a current [A], from a cache: searches begin with the same currents."""
    return model.start(starting_current_a)


def _table(motion: Callable[[FloatArray], tuple[FloatArray, FloatArray]], knots: FloatArray) -> FloatArray:
    """Return a table: speed, the integrals of 1 / a, v / a and P / a over it, and these three themselves.

    They are the derivatives of time, distance and energy by speed, as dt = dv / a, ds = v dt and dE = P dt. `motion`
    returns accelerations a and powers P at speeds.
    """
    half = 0.5 * np.diff(knots)[:, None]
    points = knots[:-1, None] + half * (1 + POINTS)
    acceleration, power = (values.reshape(points.shape) for values in motion(points.ravel()))
    rows = [knots]
    for rate in (1 / acceleration, points / acceleration, power / acceleration):
        rows.append(np.append(0.0, np.cumsum((half * WEIGHTS * rate).sum(axis=1))))
    acceleration, power = motion(knots)
    return frozen_array(np.array([*rows, 1 / acceleration, knots / acceleration, power / acceleration]))
