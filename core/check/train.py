"""The train and its line: masses, running resistance, largest efforts, gradients, curves, speed limits, stops.

All from a scenario's own keys, in the conventions that its file format states:

    weight (kN)          m g / 1000, m = tare + load, a share of the capacity or tonnes
    inertia              (1 + rotating mass factor) m, or the empty train's inertia plus the load
    running resistance   A + B v + C tau v^2, each a sum of specific terms times the weight and absolute terms,
                         and a starting resistance S (1 - v / v_e) up to v_e, at its mean over the cell's length
    gradient             weight x per mille, curve: weight x curve constant / radius

With a wind w against the train the air meets it at v + w, which adds C w^2 to A and 2 C w to B, also in tunnels.

tau is the factor of tunnels. In a cell v and v^2 are the means of both ends, and the line's values are means over the
cell and over the train behind its front: at its front for a train without length, over its length, or at the centres
of its cars, or at its front or its middle where the vehicle asks for that. Before the start the first value continues.
A limit holds for the front of the train, or until its rear has left it, and `line.limit_margin_m` before it begins. A
neutral section, a limit of traction and a rail condition of a part of the line are where the front is.

With a rail condition, the driven axles transmit at most mu(v) times their weight, in driving and in electric
braking, and all brakes together at most mu(v) times the weight of the braked axles. On dry rails (Curtius, Kniffler,
1944), with v in km/h, mu(v) = 7.5 / (v + 44) + 0.161; on wet rails it is `wet_share` of that.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario, Section, Vehicle
from railjoule.core.scenario.line import TractionLimit
from railjoule.core.scenario.vehicle import Braking, Traction
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2, W_PER_KW

# at standstill power limits nothing; this only avoids the division by zero
STANDSTILL_MS = 1e-9
END_M = 1e-6
"""A station this close to an end of the line is that end."""


@dataclass(frozen=True)
class Stop:
    """A planned stop between the ends of a line.

    Parameters
    ----------
    position_m : float
        Place at which the front of the train stops, in running order [m].
    dwell_s : float
        Standing time [s].
    window_s : tuple of float
        Earliest and latest arrival [s].
    """

    position_m: float
    dwell_s: float
    window_s: tuple[float, float] = (0.0, np.inf)


@dataclass(frozen=True, eq=False)
class Route:
    """A line in running order.

    Parameters
    ----------
    sections : tuple of Section
        In running order; `gradient_sign` turns their gradients.
    gradient_sign : float
        -1 on a line that is driven from its end.
    limits : tuple of (float, float, float)
        Further limits: from [m], to [m], speed [m/s].
    stops : tuple of Stop
    end_window_s : tuple of float
        Earliest and latest arrival at the end of the line [s]; 0 and infinite where they are free.
    passes : tuple of (float, float)
        Places [m] that are passed at a given speed [m/s].
    neutral : tuple of (float, float)
        Stretches without traction power: from [m], to [m].
    restricted : tuple of (float, float, TractionLimit)
        Stretches with limits of traction: from [m], to [m], the limits.
    rails : tuple of (float, float, str)
        Stretches with a rail condition of their own: from [m], to [m], the condition.
    train_m : float or None
        Length of the train [m].
    points_m : sequence of float or None
        Distances behind the front of the points for gradient, curve and tunnel [m]; None for all of the train.
    limits_last_m, limits_early_m : float
        Distance beyond its end at which a limit still holds for the front, and before its begin at which it does [m].
    """

    sections: tuple[Section, ...]
    gradient_sign: float
    limits: tuple[tuple[float, float, float], ...]
    stops: tuple[Stop, ...]
    end_window_s: tuple[float, float]
    passes: tuple[tuple[float, float], ...]
    neutral: tuple[tuple[float, float], ...]
    restricted: tuple[tuple[float, float, TractionLimit], ...]
    rails: tuple[tuple[float, float, str], ...]
    train_m: float | None
    points_m: Sequence[float] | None
    limits_last_m: float
    limits_early_m: float

    @cached_property
    def borders_m(self) -> FloatArray:
        """Borders of the sections [m]; shape (sections + 1,)."""
        return np.cumsum([0.0, *(section.length_m for section in self.sections)])

    @property
    def length_m(self) -> float:
        """Length of the line [m]."""
        return float(self.borders_m[-1])

    def gradient_permille(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean gradient under the train in cells [per mille]; shape (k,)."""
        return self._under_train([self.gradient_sign * one.gradient_permille for one in self.sections], start_m, end_m)

    def curvature_per_m(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean of 1 / radius under the train in cells [1/m]; shape (k,)."""
        radii = (section.curve_radius_m for section in self.sections)
        return self._under_train([1 / radius if radius > 0 else 0.0 for radius in radii], start_m, end_m)

    def tunnel_factor(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean factor of tunnels under the train in cells; shape (k,)."""
        return self._under_train([section.tunnel_factor for section in self.sections], start_m, end_m)

    def _under_train(self, values: Sequence[float], start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean of values of the sections over each cell and over the train; shape (k,)."""
        # A mean over a stretch is a difference of integrals over its length. So one function serves points, cars and
        # trains with a length, and the product's own profile of the line is not needed.
        if not np.ptp(values):
            return np.full(len(start_m), values[0])
        train = self.train_m or 0.0
        # the first section continues before the start for the length of the train, and for one metre more, as the
        # train's end is then never outside, whatever rounding does
        borders = np.append(-1.0 - train, self.borders_m)
        once = np.append(0.0, np.cumsum(np.append(values[0], values) * np.diff(borders)))
        # between borders the integral is linear, so its own integral is one of trapezoids
        twice = np.append(0.0, np.cumsum(0.5 * (once[1:] + once[:-1]) * np.diff(borders)))

        def second(places: FloatArray) -> FloatArray:
            before = np.clip(np.searchsorted(borders, places, side="right") - 1, 0, len(borders) - 2)
            trapezoid = 0.5 * (once[before] + np.interp(places, borders, once)) * (places - borders[before])
            return np.asarray(twice[before] + trapezoid)

        def area(places: FloatArray) -> FloatArray:
            if self.points_m is None:
                return (second(places) - second(places - train)) / train
            return np.asarray(np.mean([np.interp(places - point, borders, once) for point in self.points_m], axis=0))

        return (area(end_m) - area(start_m)) / (end_m - start_m)

    def speed_limit_ms(self, position_m: FloatArray) -> FloatArray:
        """Return the limit of the line at places that lie on no border [m/s], infinite without one; same shape."""
        number = np.clip(np.searchsorted(self.borders_m, position_m) - 1, 0, len(self.sections) - 1)
        by_section = np.array([(section.speed_limit_kmh or np.inf) * MS_PER_KMH for section in self.sections])
        limit = np.asarray(by_section[number])
        # a limit that begins early, or lasts for the cars behind, is one more stretch around its section
        around = list(zip(self.borders_m[:-1], self.borders_m[1:], by_section, strict=True))
        for start, end, speed in [*self.limits, *around]:
            inside = (position_m > start - self.limits_early_m) & (position_m < end + self.limits_last_m)
            limit = np.where(inside, np.minimum(limit, speed), limit)
        return limit

    @property
    def limit_borders_m(self) -> FloatArray:
        """Places at which the limit may change [m], rising."""
        starts = np.array([*self.borders_m, *(start for start, _, _ in self.limits)]) - self.limits_early_m
        ends = np.array([*self.borders_m, *(end for _, end, _ in self.limits)]) + self.limits_last_m
        places = np.concatenate([self.borders_m, starts, ends])
        return np.unique(places[places >= 0])


def build_route(scenario: Scenario) -> Route:
    """Return the line of a scenario in running order."""
    line, vehicle = scenario.line, scenario.vehicle
    length = sum(section.length_m for section in line.sections)
    limits = [(limit.from_m, limit.to_m, limit.limit_kmh * MS_PER_KMH) for limit in line.speed_limits]
    stations = [(station.position_m, station.dwell_s, station.window_s) for station in line.stations]
    passes = [(point.position_m, point.speed_kmh * MS_PER_KMH) for point in line.passing_points]
    neutral = [(section.from_m, section.to_m) for section in line.neutral_sections]
    restricted = [(limit.from_m, limit.to_m, limit) for limit in line.traction_limits]
    rails = [(stretch.from_m, stretch.to_m, stretch.condition) for stretch in line.rail_conditions]
    if line.reverse:
        restricted = [(length - end, length - start, limit) for start, end, limit in restricted]
        rails = [(length - end, length - start, condition) for start, end, condition in rails]
        neutral = [(length - end, length - start) for start, end in neutral]
        limits = [(length - end, length - start, speed) for start, end, speed in limits]
        stations = [(length - place, dwell, window) for place, dwell, window in reversed(stations)]
        passes = [(length - place, speed) for place, speed in reversed(passes)]
    return Route(
        sections=tuple(reversed(line.sections)) if line.reverse else line.sections,
        gradient_sign=-1.0 if line.reverse else 1.0,
        limits=tuple(limits),
        stops=tuple(Stop(*station) for station in stations if END_M < station[0] < length - END_M),
        end_window_s=next((window for place, _, window in stations if place >= length - END_M), (0.0, np.inf)),
        passes=tuple(passes),
        neutral=tuple(neutral),
        restricted=tuple(restricted),
        rails=tuple(rails),
        train_m=vehicle.length_m,
        points_m=_points_m(vehicle),
        limits_last_m=(vehicle.length_m or 0.0) if line.limits_hold_for == "whole_train" else 0.0,
        limits_early_m=line.limit_margin_m,
    )


def _points_m(vehicle: Vehicle) -> Sequence[float] | None:
    """Return the places behind the front at which a train takes the line [m]; None for its whole length."""
    if vehicle.length_m is None or vehicle.gradient_at == "front":
        return (0.0,)
    if vehicle.gradient_at == "middle":
        return (0.5 * vehicle.length_m,)
    cars = vehicle.car_count
    return None if cars is None else [(car + 0.5) * vehicle.length_m / cars for car in range(cars)]


@dataclass(frozen=True)
class Train:
    """The properties of a vehicle that determine its motion.

    Parameters
    ----------
    weight_kn : float
        Weight [kN].
    inertia_kg : float
        Mass that resists acceleration [kg].
    constant_n, linear, quadratic : float
        A [N], B [N s/m] and C [N s2/m2] of the running resistance in the open.
    curve_constant_m_n_per_kn : float
        Curve resistance times radius, over weight [N m/kN].
    starting_n, starting_ends_ms : float
        Starting resistance at rest [N], and the speed at which it has fallen to nothing [m/s].
    """

    weight_kn: float
    inertia_kg: float
    constant_n: float
    linear: float
    quadratic: float
    curve_constant_m_n_per_kn: float
    starting_n: float
    starting_ends_ms: float

    def mean_starting_n(self, entering_speed2: FloatArray, leaving_speed2: FloatArray) -> FloatArray:
        """Return the mean starting resistance over the length of cells [N], whose v^2 is linear over it."""
        if self.starting_n == 0:
            return np.zeros(len(entering_speed2))
        # its work up to a speed, over a change of v^2 of 1; the mean of three speeds where v^2 hardly changes
        ends, rise = self.starting_ends_ms, leaving_speed2 - entering_speed2
        slow = [np.minimum(speed2**0.5, ends) for speed2 in (entering_speed2, leaving_speed2)]
        work = [v**2 - 2 * v**3 / (3 * ends) for v in slow]
        middle = np.maximum(1 - (0.5 * (entering_speed2 + leaving_speed2)) ** 0.5 / ends, 0.0)
        varies = np.abs(rise) > 1e-5 * (entering_speed2 + leaving_speed2)
        return self.starting_n * np.where(varies, (work[1] - work[0]) / np.where(varies, rise, 1.0), middle)


def build_train(vehicle: Vehicle, head_wind_ms: float = 0.0) -> Train:
    """Return the train of a vehicle with its load, in a wind against it [m/s]."""
    load = load_kg(vehicle)
    mass = vehicle.tare_kg + load
    if vehicle.inertial_mass_kg is None:
        # a load does not turn, but a factor is one of the whole mass: the convention of the file format
        inertia = (1 + (vehicle.rotating_mass_factor or 0.0)) * mass
    else:
        inertia = vehicle.inertial_mass_kg + load
    weight = mass * STANDARD_GRAVITY_MS2 / N_PER_KN
    resistance = vehicle.resistance
    cars = vehicle.car_count or 1

    def force(power: int, name: str) -> float:
        """In N and km/h: of all cars, of the kinds in proportion to their number, and of the load's own weight."""
        of_kinds = sum(kind.cars * float(getattr(kind, name)) for kind in resistance.car_kinds) / cars
        of_train = resistance.specific[power] + of_kinds
        of_load = getattr(resistance.load, name)
        carried = load * STANDARD_GRAVITY_MS2 / N_PER_KN * (of_train if of_load is None else of_load)
        return (weight - load * STANDARD_GRAVITY_MS2 / N_PER_KN) * of_train + carried + resistance.absolute[power]

    air = force(2, "quadratic_n_per_kn_per_kmh2") / MS_PER_KMH**2
    linear = force(1, "linear_n_per_kn_per_kmh") / MS_PER_KMH
    return Train(
        weight_kn=weight,
        inertia_kg=inertia,
        constant_n=force(0, "constant_n_per_kn") + air * head_wind_ms**2,
        linear=linear + 2 * air * head_wind_ms,
        quadratic=air,
        curve_constant_m_n_per_kn=resistance.curve_constant_m_n_per_kn,
        starting_n=weight * resistance.starting_n_per_kn + resistance.starting_n,
        starting_ends_ms=(resistance.starting_ends_at_kmh or 0.0) * MS_PER_KMH,
    )


def load_kg(vehicle: Vehicle) -> float:
    """Return the mass on board [kg]."""
    if vehicle.load_t is not None:
        return 1000.0 * vehicle.load_t
    freight = vehicle.max_load_t
    by_passenger = vehicle.capacity_passengers * vehicle.passenger_mass_kg
    return vehicle.load_factor * (by_passenger if freight is None else 1000.0 * freight)


def stated_limits_n(limits: Traction | Braking, speed_ms: FloatArray) -> dict[str, FloatArray]:
    """Return the largest efforts [N] by what states them: effort, power, curve, breakdown; shape as the speeds'.

    Beyond the last point of a curve its power stays, F v = F_last v_last. Beyond the breakdown speed F v^2 stays as it
    is there, and the limit is infinite below.
    """
    speed, stated = np.maximum(speed_ms, STANDSTILL_MS), {}
    if limits.max_effort_kn is not None:
        stated["effort"] = np.full(np.shape(speed_ms), limits.max_effort_kn * N_PER_KN)
    if limits.max_power_kw is not None:
        stated["power"] = limits.max_power_kw * W_PER_KW / speed
    if limits.curve is not None:
        kmh, kn = np.array(limits.curve).T
        # at a step the lower effort: the curve is read from both sides
        sides = (np.interp(np.nextafter(speed, end), kmh * MS_PER_KMH, N_PER_KN * kn) for end in (0.0, np.inf))
        inside = np.minimum(*sides)
        last_ms = kmh[-1] * MS_PER_KMH
        stated["curve"] = np.where(speed > last_ms, N_PER_KN * kn[-1] * last_ms / speed, inside)
    if limits.breakdown_speed_kmh is not None:
        breakdown = np.array([limits.breakdown_speed_kmh * MS_PER_KMH])
        without = stated_limits_n(limits.model_copy(update={"breakdown_speed_kmh": None}), breakdown)
        constant = min(float(limit[0]) for limit in without.values()) * breakdown**2
        stated["breakdown"] = np.where(speed_ms > breakdown, constant / speed**2, np.inf)
    return stated


def adhesion_limits_n(scenario: Scenario, speed_ms: FloatArray, condition: str | None) -> tuple[FloatArray, FloatArray]:
    """Return the largest forces of the driven and of the braked axles [N] at speeds [m/s] on rails of a condition.

    They are infinite where there is no limit.
    """
    vehicle = scenario.vehicle
    adhesion = vehicle.adhesion
    if condition is None or adhesion.driven_mass_share is None:
        unlimited = np.full(len(speed_ms), np.inf)
        return unlimited, unlimited
    mass_kg = vehicle.tare_kg + load_kg(vehicle)
    wet = adhesion.wet_share if condition == "wet" else 1.0
    force_n = wet * (7.5 / (speed_ms / MS_PER_KMH + 44) + 0.161) * mass_kg * STANDARD_GRAVITY_MS2
    return adhesion.driven_mass_share * force_n, adhesion.braked_mass_share * force_n
