"""The train and its line: masses, resistances of running, gradients, curves and tunnels, speed limits, stops.

All from a scenario's own keys, in the conventions that its file format states:

    weight (kN)          m g / 1000, m = tare + load factor x capacity x mass of a passenger
    inertia              (1 + rotating mass factor) m, or the empty train's inertia plus the load
    running resistance   A + B v + C tau v^2, each a sum of specific terms times the weight and absolute terms
    gradient             weight x per mille, curve: weight x curve constant / radius

With a wind w against the train the air meets it at v + w, which adds C w^2 to A and 2 C w to B, also in tunnels.

tau is the factor of tunnels. In a cell v and v^2 are the means of both ends, and the line's values are means over the
cell and over the train behind its front: at its front for a train without length, over its length, or at the centres
of its cars, or at its front or its middle where the vehicle asks for that. Before the start the first value continues.
A limit holds for the front of the train, or until its rear has left it. A neutral section is where its front is.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario, Section, Vehicle
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2

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
    train_m, cars
        Length of the train [m] and number of its cars, or None.
    at_point_m : float or None
        Distance behind the front of the point for gradient, curve and tunnel [m]; None for all of the train.
    limits_last_m : float
        Distance beyond its end at which a limit still holds for the front [m].
    """

    sections: tuple[Section, ...]
    gradient_sign: float
    limits: tuple[tuple[float, float, float], ...]
    stops: tuple[Stop, ...]
    end_window_s: tuple[float, float]
    passes: tuple[tuple[float, float], ...]
    neutral: tuple[tuple[float, float], ...]
    train_m: float | None
    cars: int | None
    at_point_m: float | None
    limits_last_m: float

    @cached_property
    def borders_m(self) -> FloatArray:
        """Borders of the sections [m]; shape (sections + 1,)."""
        return np.cumsum([0.0, *(section.length_m for section in self.sections)])

    @property
    def length_m(self) -> float:
        """Length of the line [m]."""
        return float(self.borders_m[-1])

    @property
    def spreads_evenly(self) -> bool:
        """Whether values of the line are means over the length of the train."""
        return self.train_m is not None and self.cars is None and self.at_point_m is None

    def gradient_permille(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean gradient under the train in cells [per mille]; shape (k,)."""
        return self._under_train(lambda section: self.gradient_sign * section.gradient_permille, start_m, end_m)

    def curvature_per_m(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean of 1 / radius under the train in cells [1/m]; shape (k,)."""
        return self._under_train(
            lambda section: 1 / section.curve_radius_m if section.curve_radius_m > 0 else 0.0, start_m, end_m
        )

    def tunnel_factor(self, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean factor of tunnels under the train in cells; shape (k,)."""
        return self._under_train(lambda section: section.tunnel_factor, start_m, end_m)

    def _under_train(self, value: Callable[[Section], float], start_m: FloatArray, end_m: FloatArray) -> FloatArray:
        """Return the mean of a value of the sections over each cell and over the train; shape (k,)."""
        # A mean over a stretch is a difference of integrals over its length. So one function serves points, cars and
        # trains with a length, and the product's own profile of the line is not needed.
        values = np.array([value(section) for section in self.sections])
        if not np.ptp(values):
            return np.full(len(start_m), values[0])
        area = self._integral(values)
        means: FloatArray = (area(end_m) - area(start_m)) / (end_m - start_m)
        return means

    def _integral(self, values: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return the integral over the position of the front of a mean under the train."""
        # the first section continues before the start for the length of the train
        # one metre more, as the train's end is then never outside, whatever rounding does
        borders = np.append(-1.0 - (self.train_m or 0.0), self.borders_m)
        once = np.append(0.0, np.cumsum(np.append(values[0], values) * np.diff(borders)))

        def first(places: FloatArray) -> FloatArray:
            area: FloatArray = np.interp(places, borders, once)
            return area

        train, cars = self.train_m, self.cars
        if self.at_point_m is not None:
            point_m = self.at_point_m
            return lambda places: first(places - point_m)
        if train is None:
            return first
        if cars is not None:
            behind = (np.arange(cars) + 0.5) * train / cars
            return lambda places: np.mean([first(places - offset) for offset in behind], axis=0)
        # between borders the integral is linear, so its own integral is one of trapezoids
        twice = np.append(0.0, np.cumsum(0.5 * (once[1:] + once[:-1]) * np.diff(borders)))

        def second(places: FloatArray) -> FloatArray:
            before = np.clip(np.searchsorted(borders, places, side="right") - 1, 0, len(borders) - 2)
            trapezoid: FloatArray = 0.5 * (once[before] + first(places)) * (places - borders[before])
            return twice[before] + trapezoid

        return lambda places: (second(places) - second(places - train)) / train

    def speed_limit_ms(self, position_m: FloatArray) -> FloatArray:
        """Return the limit of the line at places that lie on no border [m/s], infinite without one; same shape."""
        number = np.clip(np.searchsorted(self.borders_m, position_m) - 1, 0, len(self.sections) - 1)
        by_section = np.array([(section.speed_limit_kmh or np.inf) * MS_PER_KMH for section in self.sections])
        limit: FloatArray = by_section[number]
        # a limit that lasts for the cars behind is one more stretch after its section
        behind = [(end, end, speed) for end, speed in zip(self.borders_m[1:], by_section, strict=True)]
        for start, end, speed in [*self.limits, *behind]:
            inside = (position_m > start) & (position_m < end + self.limits_last_m)
            limit = np.where(inside, np.minimum(limit, speed), limit)
        return limit

    @property
    def limit_borders_m(self) -> FloatArray:
        """Places at which the limit may change [m], rising."""
        ends = [place for start, end, _ in self.limits for place in (start, end + self.limits_last_m)]
        return np.unique(np.concatenate([self.borders_m, self.borders_m + self.limits_last_m, ends]))


def build_route(scenario: Scenario) -> Route:
    """Return the line of a scenario in running order."""
    line, vehicle = scenario.line, scenario.vehicle
    length = sum(section.length_m for section in line.sections)
    limits = [(limit.from_m, limit.to_m, limit.limit_kmh * MS_PER_KMH) for limit in line.speed_limits]
    stations = [
        (
            station.position_m,
            station.dwell_s,
            (
                station.earliest_arrival_s or 0.0,
                np.inf if station.latest_arrival_s is None else station.latest_arrival_s,
            ),
        )
        for station in line.stations
    ]
    passes = [(point.position_m, point.speed_kmh * MS_PER_KMH) for point in line.passing_points]
    neutral = [(section.from_m, section.to_m) for section in line.neutral_sections]
    if line.reverse:
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
        train_m=vehicle.length_m,
        cars=vehicle.car_count,
        at_point_m={"front": 0.0, "middle": 0.5 * (vehicle.length_m or 0.0)}.get(vehicle.gradient_at),
        limits_last_m=(vehicle.length_m or 0.0) if line.limits_hold_for == "whole_train" else 0.0,
    )


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
    """

    weight_kn: float
    inertia_kg: float
    constant_n: float
    linear: float
    quadratic: float
    curve_constant_m_n_per_kn: float


def build_train(vehicle: Vehicle, head_wind_ms: float = 0.0) -> Train:
    """Return the train of a vehicle with its load, in a wind against it [m/s]."""
    load = vehicle.load_factor * vehicle.capacity_passengers * vehicle.passenger_mass_kg
    mass = vehicle.tare_kg + load
    if vehicle.inertial_mass_kg is None:
        # passengers do not turn, but a factor is one of the whole mass: the convention of the file format
        inertia = (1 + (vehicle.rotating_mass_factor or 0.0)) * mass
    else:
        inertia = vehicle.inertial_mass_kg + load
    weight = mass * STANDARD_GRAVITY_MS2 / N_PER_KN
    resistance = vehicle.resistance
    cars = vehicle.car_count or 1

    def specific(name: str) -> float:
        """Over the weight of the train: what all cars have, and what the kinds have in proportion to their number."""
        of_kinds = sum(kind.cars * float(getattr(kind, name)) for kind in resistance.car_kinds) / cars
        return float(getattr(resistance, name)) + of_kinds

    air = (weight * specific("quadratic_n_per_kn_per_kmh2") + resistance.quadratic_n_per_kmh2) / MS_PER_KMH**2
    linear = (weight * specific("linear_n_per_kn_per_kmh") + resistance.linear_n_per_kmh) / MS_PER_KMH
    return Train(
        weight_kn=weight,
        inertia_kg=inertia,
        constant_n=weight * specific("constant_n_per_kn") + resistance.constant_n + air * head_wind_ms**2,
        linear=linear + 2 * air * head_wind_ms,
        quadratic=air,
        curve_constant_m_n_per_kn=resistance.curve_constant_m_n_per_kn,
    )
