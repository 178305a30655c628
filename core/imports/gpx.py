"""Tracks in GPX: the points of a recorded track, or of a route, as a table over the distance along them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import NoReturn
from xml.parsers import expat

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Notes
from railjoule.core.imports.source_file import MAX_BYTES, SourceFile
from railjoule.core.scenario._sentences import show

# NGA.STND.0036_1.0.0_WGS84, table 3.1
SEMI_MAJOR_AXIS_M, FLATTENING = 6_378_137.0, 1 / 298.257223563
MAX_POINTS = 200_000
LONGEST_TEXT = 200
LEAVES = ("ele", "time", "speed", "name")
"""Elements that are read: `speed` is one of GPX 1.0, and in GPX 1.1 one of a point's extensions, in m/s."""
HEADER = ("time", "position [m]", "speed [m/s]", "elevation [m]")
Texts = dict[str, str]


@dataclass
class _Track:
    name: str = ""
    points: list[Texts] = field(default_factory=list)
    segments: list[int] = field(default_factory=list)
    """The number of points before the begin of each segment."""


class _Reader:
    """Collects the points of all tracks while a file is parsed; no tree of its elements is made."""

    def __init__(self, source: str) -> None:
        self.source, self.tracks = source, list[_Track]()
        self.point: Texts | None = None
        self.text: list[str] | None = None
        self.has_root = False

    def refuse(self, *_: object) -> NoReturn:
        # a document type may define entities, which can stand for very much or for another file; GPX has none
        raise ScenarioError(f"{self.source}: a document type (<!DOCTYPE) is not read; remove it.")

    def start(self, tag: str, attributes: Texts) -> None:
        name = tag.rpartition(":")[2]
        if not self.has_root and name != "gpx":
            raise ScenarioError(f"{self.source}: its first element is {show(name)}; only XML of GPX is read.")
        self.has_root = True
        if name in {"trk", "rte"}:
            self.tracks.append(_Track())
        elif name == "trkseg" and self.tracks:
            self.tracks[-1].segments.append(len(self.tracks[-1].points))
        elif name in {"trkpt", "rtept"} and self.tracks:
            self.point = {key: attributes.get(key, "") for key in ("lat", "lon")}
            self.tracks[-1].points.append(self.point)
            if len(self.tracks[-1].points) > MAX_POINTS:
                raise ScenarioError(f"{self.source}: more than the {MAX_POINTS} points allowed in a track.")
        self.text = [] if name in LEAVES else None

    def add_text(self, text: str) -> None:
        if self.text is not None and sum(map(len, self.text)) < LONGEST_TEXT:
            self.text.append(text)

    def end(self, tag: str) -> None:
        name = tag.rpartition(":")[2]
        if name in {"trkpt", "rtept"}:
            self.point = None
        elif self.text is not None and self.tracks:
            text = "".join(self.text).strip()[:LONGEST_TEXT]
            if self.point is not None:
                self.point.setdefault(name, text)
            elif name == "name":
                self.tracks[-1].name = text
        self.text = None


def is_gpx(source: SourceFile) -> bool:
    """Return whether a file is XML, of which only GPX is read."""
    return source.name.lower().endswith(".gpx") or source.content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] == b"<"


def read_track_points(
    source: SourceFile, track: str | None, notes: Notes
) -> tuple[tuple[str, ...], list[tuple[int, tuple[str | float, ...]]]]:
    """Read the points of a track as a table.

    Parameters
    ----------
    source : SourceFile
        GPX 1.0 or 1.1.
    track : str, optional
        Name of the track; by default its only one.
    notes : Notes
        Receives the origin of distances and speeds.

    Returns
    -------
    header : tuple of str
        Those of `HEADER` that the track has.
    rows : list of (int, tuple)
        The points with their numbers from 1.

    Raises
    ------
    ChoiceError
        If there are several tracks and none is named.
    ScenarioError
        If it is no GPX, or a point has no place.
    """
    tracks = _parsed(source)
    names = [one.name or f"track {number}" for number, one in enumerate(tracks, 1)]
    names = [name if names.count(name) == 1 else f"{name} ({number})" for number, name in enumerate(names, 1)]
    chosen = tracks[notes.chosen(names, track, "track")]
    points = chosen.points
    if len(points) < 2:
        raise ScenarioError(f"{source.name}: the track has {len(points)} points, and needs at least 2.")
    latitude, longitude = (_numbers(points, key, source.name) for key in ("lat", "lon"))
    position = distance_along_m(latitude, longitude)
    notes.add("reading", "distances are sums of those between the points, on the ellipsoid WGS 84.")
    _tell_gaps(chosen.segments, position, notes)
    time_s = np.array([_time_s(point.get("time", ""), number, source.name) for number, point in enumerate(points, 1)])
    columns: dict[str, Sequence[str | float]] = {"position [m]": [round(float(one), 3) for one in position]}
    if np.any(np.isfinite(time_s)):
        columns["time"] = [point.get("time", "") for point in points]
        if any(point.get("speed") for point in points):
            columns["speed [m/s]"] = [point.get("speed", "") for point in points]
        else:
            notes.add("reading", "it has no speeds: each is that between the points before and after.")
            speed = _speed_ms(time_s, position)
            columns["speed [m/s]"] = [round(float(one), 4) if math.isfinite(one) else "" for one in speed]
    if any(point.get("ele") for point in points):
        columns["elevation [m]"] = [point.get("ele", "") for point in points]
    header = tuple(name for name in HEADER if name in columns)
    return header, list(enumerate(zip(*(columns[name] for name in header), strict=True), 1))


def _tell_gaps(segments: Sequence[int], position_m: FloatArray, notes: Notes) -> None:
    """Note how much of the distance lies between segments, where the receiver had no signal."""
    begins = sorted({first for first in segments if 0 < first < len(position_m)})
    if begins:
        gap_m = sum(position_m[first] - position_m[first - 1] for first in begins)
        notes.add("reading", f"its {len(begins) + 1} segments are joined by straight lines, {gap_m:.0f} m in all.")


def distance_along_m(latitude_deg: FloatArray, longitude_deg: FloatArray) -> FloatArray:
    """Return the distance along points from the first one [m]; shape (n,).

    Between two points it is that on the ellipsoid WGS 84 with its radii of curvature at their mean latitude, as in
    Snyder, *Map Projections: A Working Manual*, USGS Professional Paper 1395 (1987), pages 24 and 25. Over
    10 km this is right to a millionth, whereas a sphere is wrong by up to 0.6 per cent over any distance.

    Parameters
    ----------
    latitude_deg, longitude_deg : array of shape (n,)
        Places [degrees].
    """
    phi, lam = np.radians(latitude_deg), np.radians(longitude_deg)
    mean = 0.5 * (phi[1:] + phi[:-1])
    squared_eccentricity = FLATTENING * (2 - FLATTENING)
    root = np.sqrt(1 - squared_eccentricity * np.sin(mean) ** 2)
    north = SEMI_MAJOR_AXIS_M * (1 - squared_eccentricity) / root**3 * np.diff(phi)
    # the shorter way round the Earth
    turn = np.remainder(np.diff(lam) + np.pi, 2 * np.pi) - np.pi
    east = SEMI_MAJOR_AXIS_M / root * np.cos(mean) * turn
    return np.append(0.0, np.cumsum(np.hypot(north, east)))


def _parsed(source: SourceFile) -> list[_Track]:
    name = source.name
    if len(source.content) > MAX_BYTES:
        raise ScenarioError(f"{name}: larger than the {MAX_BYTES / 1e6:g} MB permitted.")
    reader, parser = _Reader(name), expat.ParserCreate()
    parser.StartDoctypeDeclHandler = reader.refuse
    parser.StartElementHandler, parser.EndElementHandler = reader.start, reader.end
    parser.CharacterDataHandler = reader.add_text
    try:
        parser.Parse(source.content, True)
    # of an encoding that Python does not have
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise ScenarioError(f"{name}: not XML: {show(str(error))}.") from None
    tracks = [track for track in reader.tracks if track.points]
    if not tracks:
        raise ScenarioError(f"{name}: has no track and no route.")
    return tracks


def _numbers(points: Sequence[Texts], key: str, source: str) -> FloatArray:
    """Return latitudes or longitudes; ScenarioError if one is none."""
    most = 90.0 if key == "lat" else 180.0
    values = []
    for number, point in enumerate(points, 1):
        try:
            value = float(point[key])
        except ValueError:
            value = math.nan
        if not abs(value) <= most:
            raise ScenarioError(
                f"{source}, point {number}: {key} = {show(point[key])} must be from {-most:g} to {most:g} degrees."
            )
        values.append(value)
    return np.array(values)


def _time_s(text: str, number: int, source: str) -> float:
    if not text:
        return math.nan
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise ScenarioError(f"{source}, point {number}: time = {show(text)} must be as 2026-01-31T10:15:30Z.") from None
    return moment.replace(tzinfo=moment.tzinfo or UTC).timestamp()


def _speed_ms(time_s: FloatArray, position_m: FloatArray) -> FloatArray:
    """Return the mean speed between the points before and after each one; NaN without times."""
    speed, timed = np.full(len(time_s), np.nan), np.flatnonzero(np.isfinite(time_s))
    # of points at one time the first counts, as in recordings: else twice the way would count for one step
    is_first = np.append(True, np.diff(time_s[timed]) != 0)
    distinct = timed[is_first]
    place = np.arange(len(distinct))
    before, after = distinct[np.maximum(place - 1, 0)], distinct[np.minimum(place + 1, len(distinct) - 1)]
    steps = time_s[after] - time_s[before]
    rising = steps > 0
    speed[distinct[rising]] = (position_m[after] - position_m[before])[rising] / steps[rising]
    speed[timed] = speed[distinct][np.cumsum(is_first) - 1]
    return speed
