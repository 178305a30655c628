"""The place of a measured run on its line, and the factor by which its odometer is off.

A run that is as long as the line lies on all of it. Of a shorter one every place along the line is tried, and judged by
the knowledge in the run: it stands at stations, keeps to speed limits, and where efforts are measured the work at
the wheels that neither the speed nor the resistance takes has gone into height. All three are sums over distance, so
that no speed is differentiated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.measured.recording import Recording
from railjoule.core.motion.line_profile import height_profile, section_borders, speed_limit_at
from railjoule.core.physics.resistance import resistance_coefficients, total_weight_kn
from railjoule.core.scenario import Line, Scenario, Section, Station
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M, STRETCHES, AnyStretch
from railjoule.core.units import MS_PER_KMH, N_PER_KN

# worn wheels are 3 to 4 % smaller than new ones
MAX_SCALE = 0.05
"""By which share an odometer may be off."""
WHOLE_LINE_SHARE = 0.02
"""A run that is longer than the line by less is one over all of it, as is one that is shorter and from rest to rest."""
STEP_M, FINE_STEP_M = 5.0, 0.5
"""Places are tried in steps of the first, and around the best one of the second."""
STOP_DEVIATION_M, FARTHEST_STOP_M = 8.0, 60.0
"""Standard deviation of where trains stand, and the largest distance that counts."""
LIMIT_DEVIATION_MS, INDEPENDENT_S = 1.0, 5.0
"""By how much limits are exceeded, and after which time that is independent of before."""
HEIGHT_DEVIATION_M, INDEPENDENT_M = 0.5, 100.0
"""The same of heights, found by the work at the wheels, over distance."""
SAME_PLACE_M = 30.0
AMBIGUOUS = 9.0
"""Half of a chi-square: another place whose misfit is larger by less is as good."""


@dataclass(frozen=True)
class Placement:
    """The place of a run on its line [m], in running order, and the sentence on how it was found.

    `scale` is distances on the line over those by the recorder's speed.
    """

    start_m: float
    end_m: float
    scale: float
    line_m: float
    how: str

    @property
    def is_whole_line(self) -> bool:
        """Whether the run covers all of its line."""
        return self.start_m == 0 and self.end_m == self.line_m


def place_on_line(recording: Recording, scenario: Scenario, start_m: float | None = None) -> Placement:
    """Find the place of a run on the line of a scenario.

    Parameters
    ----------
    recording : Recording
        The run.
    scenario : Scenario
        Line and vehicle.
    start_m : float, optional
        Its begin [m], if that is known.

    Raises
    ------
    RecordingError
        If the run is longer than the line or leaves it, or several places fit alike.
    """
    line = scenario.line.in_running_order()
    covered = float(recording.covered_m[-1])
    # the odometer counts turns of the wheel and not samples of a speed, so that it is asked first
    length = covered if recording.position_m is None else float(recording.position_m[-1])
    if start_m is not None:
        placement = _from_place(recording, line, start_m, length)
    elif abs(length - line.length_m) <= WHOLE_LINE_SHARE * line.length_m and (
        recording.rests or length >= line.length_m
    ):
        placement = Placement(
            0.0, line.length_m, line.length_m / covered, line.length_m, "The run lies on the whole line."
        )
    elif length > line.length_m:
        raise RecordingError(
            f"{recording.name}: the run covers {length:.5g} m, but the line of the scenario has {line.length_m:.5g} m."
        )
    else:
        placement = _searched(recording, scenario, line, length)
    if abs(placement.scale - 1) > MAX_SCALE:
        raise RecordingError(
            f"{recording.name}: the speeds cover {covered:.5g} m where the line has "
            f"{placement.end_m - placement.start_m:.5g} m; they may differ by at most {100 * MAX_SCALE:g} %."
        )
    return placement


def _from_place(recording: Recording, line: Line, start_m: float, length_m: float) -> Placement:
    if not 0 <= start_m < line.length_m:
        raise RecordingError(
            f"--from {start_m:g}: must be at least 0 and below {line.length_m:g} m, the line's length."
        )
    end = _snapped(line, recording, start_m + length_m, -1)
    if end > line.length_m + WHOLE_LINE_SHARE * length_m:
        raise RecordingError(
            f"{recording.name}: the run covers {length_m:.5g} m from {start_m:g} m on, but the line ends at "
            f"{line.length_m:g} m."
        )
    end = min(end, line.length_m)
    scale = (end - start_m) / float(recording.covered_m[-1])
    return Placement(start_m, end, scale, line.length_m, f"The run begins at {start_m:g} m, as given.")


def _snapped(line: Line, recording: Recording, place_m: float, sample: int) -> float:
    """Return the station at which a run begins or ends, if it does so at rest beside one; else the place."""
    if recording.speed_ms[sample] > 0:
        return place_m
    stations = _stations(line)
    nearest = float(stations[np.argmin(np.abs(stations - place_m))])
    # one odometer may be off by half a per cent over a long run
    reach = max(3 * STOP_DEVIATION_M, 0.005 * float(recording.covered_m[-1]))
    return nearest if abs(nearest - place_m) <= reach else place_m


def _stations(line: Line) -> FloatArray:
    return np.unique([0.0, *(station.position_m for station in line.stations), line.length_m])


def _searched(recording: Recording, scenario: Scenario, line: Line, length_m: float) -> Placement:
    """Return the place of the least misfit."""
    scale = length_m / float(recording.covered_m[-1])
    misfit = _Misfit(recording, scenario, line, scale)
    room = line.length_m - length_m
    places = np.unique([*np.arange(0.0, room, STEP_M), room])
    costs = np.array([misfit.at(place) for place in places])
    best = float(places[np.argmin(costs)])
    around = np.arange(max(best - STEP_M, 0.0), min(best + STEP_M, room) + 1e-9, FINE_STEP_M)
    start = float(around[np.argmin([misfit.at(place) for place in around])])
    alike = places[(costs <= costs.min() + AMBIGUOUS) & (np.abs(places - start) > SAME_PLACE_M)]
    if len(alike):
        raise RecordingError(
            f"{recording.name}: the run fits the line alike from {min(start, *alike):.0f} m and from "
            f"{max(start, *alike):.0f} m on; say where it begins by --from."
        )
    start, end = _snapped(line, recording, start, 0), _snapped(line, recording, start + length_m, -1)
    known = "stations and speed limits" if misfit.climb_m is None else "stations, speed limits and heights"
    how = f"The run begins at {start:.0f} m: there it fits best to the line's {known}."
    return Placement(start, end, (end - start) / float(recording.covered_m[-1]), line.length_m, how)


class _Misfit:
    """Half of the sum of squares by which a run misses what is known of a line, over the places where it may begin."""

    def __init__(self, recording: Recording, scenario: Scenario, line: Line, scale: float) -> None:
        self.line, self.lasts_m = line, scenario.limits_last_m
        self.covered_m = scale * recording.covered_m
        self.speed_ms = scale * recording.speed_ms
        self.step_s = np.diff(recording.time_s)
        standing = self.speed_ms == 0
        self.stops_m = np.unique(np.round(self.covered_m[standing], 1))
        self.stations_m = _stations(line)
        self.borders_m, self.heights_m = section_borders(line), height_profile(line)
        self.climb_m = _climb_by_work(recording, scenario, self.covered_m, self.speed_ms)

    def at(self, start_m: float) -> float:
        """Return the misfit of a run that begins at a place [m]."""
        places = start_m + self.covered_m
        away = np.abs(start_m + self.stops_m[:, None] - self.stations_m).min(axis=1, initial=np.inf)
        cost = float(np.sum((np.minimum(away, FARTHEST_STOP_M) / STOP_DEVIATION_M) ** 2))
        limit = speed_limit_at(self.line, 0.5 * (places[1:] + places[:-1]), self.lasts_m) * MS_PER_KMH
        over = np.maximum(np.minimum(self.speed_ms[1:], self.speed_ms[:-1]) - limit, 0.0)
        cost += float(np.sum((over / LIMIT_DEVIATION_MS) ** 2 * self.step_s)) / INDEPENDENT_S
        if self.climb_m is not None:
            difference = self.climb_m - np.interp(places, self.borders_m, self.heights_m)
            # a resistance other than the scenario's goes straight up with distance, as does the unknown height at the
            # start
            basis = np.column_stack([np.ones(len(places)), self.covered_m])
            difference = difference - basis @ np.linalg.lstsq(basis, difference, rcond=None)[0]
            weights = np.gradient(self.covered_m) / INDEPENDENT_M
            cost += float(np.sum(weights * (difference / HEIGHT_DEVIATION_M) ** 2))
        return 0.5 * cost


def _climb_by_work(
    recording: Recording, scenario: Scenario, covered_m: FloatArray, speed_ms: FloatArray
) -> FloatArray | None:
    """Return the height above the start by the account of energy [m]; None without efforts for the whole run."""
    effort, brake = recording.effort_n, recording.brake_applied
    if effort is None or np.any(np.isnan(effort)) or (brake is not None and np.any(brake[speed_ms > 0])):
        return None
    constant, linear, quadratic = resistance_coefficients(scenario.vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)
    pull = effort - (constant + linear * speed_ms + quadratic * speed_ms**2)
    work = np.append(0.0, np.cumsum(0.5 * (pull[1:] + pull[:-1]) * np.diff(covered_m)))
    kinetic = 0.5 * scenario.vehicle.total_inertia_kg * (speed_ms**2 - speed_ms[0] ** 2)
    return np.asarray((work - kinetic) / (total_weight_kn(scenario.vehicle) * N_PER_KN))


# a border that rounding puts beside an end would make a section of nothing
SHORTEST_PIECE_M = 1e-6


def part_of_line(line: Line, start_m: float, end_m: float, stops: Sequence[Station]) -> Line:
    """Return the part of a line between two places.

    Parameters
    ----------
    line : Line
        In running order.
    start_m, end_m : float
        Ends of the part [m].
    stops : sequence of Station
        The stops of the part, in its own metres; they stand for those of the line.
    """
    length = end_m - start_m
    fixed = [stop.position_m for stop in stops] + [0.0, length]
    points = [
        point.model_copy(update={"position_m": point.position_m - start_m})
        for point in line.passing_points
        if min(abs(point.position_m - start_m - place) for place in fixed) >= SHORTEST_DISTANCE_M
        and start_m < point.position_m < end_m
    ]
    return line.model_copy(
        update={
            "preset": None,
            "sections": tuple(_sections_between(line, start_m, end_m)),
            **{key: _stretches_between(getattr(line, key), start_m, end_m) for key in STRETCHES},
            "stations": tuple(stops),
            "passing_points": tuple(points),
        }
    )


def _stretches_between(stretches: Sequence[AnyStretch], start_m: float, end_m: float) -> tuple[AnyStretch, ...]:
    """Cut stretches to the part between two places, in metres from the first."""
    return tuple(
        # made again, as a copy is not checked
        type(one)(
            **{
                **one.model_dump(),
                "from_m": max(one.from_m - start_m, 0.0),
                "to_m": min(one.to_m - start_m, end_m - start_m),
            }
        )
        for one in stretches
        if one.from_m < end_m - SHORTEST_PIECE_M and one.to_m > start_m + SHORTEST_PIECE_M
    )


def _sections_between(line: Line, start_m: float, end_m: float) -> list[Section]:
    borders = section_borders(line)
    lengths = (np.minimum(borders[1:], end_m) - np.maximum(borders[:-1], start_m)).tolist()
    return [
        section.model_copy(update={"length_m": length})
        for section, length in zip(line.sections, lengths, strict=True)
        if length > SHORTEST_PIECE_M
    ]
