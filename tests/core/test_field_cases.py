"""Cases that users of other programs reported, rebuilt with other numbers; each right value has its own calculation.

Sources are issues (#) and pull requests of public repositories. `OwnRun` shares no code with railjoule.
"""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from railjoule.core import InfeasibleLineError, solve
from railjoule.core.errors import RecordingError, ScenarioError
from railjoule.core.imports import ColumnMap, SourceFile, build_line, read_intervals, read_stations
from railjoule.core.imports.osrd_stock import read_osrd_stock
from railjoule.core.imports.railtoolkit import read_railtoolkit
from railjoule.core.measured import recorder_cells, run_table
from railjoule.core.scenario import scenario_from_document
from railjoule.core.scenario.document import change_document
from tests.builders import PLAIN

G_MS2, KMH = 9.81, 3.6
FREIGHT = {
    "vehicle.tare_kg": 1200e3,
    "vehicle.capacity_passengers": 0,
    "vehicle.rotating_mass_factor": 0.06,
    "vehicle.length_m": 600.0,
    "vehicle.resistance": {"constant_n_per_kn": 1.5, "quadratic_n_per_kn_per_kmh2": 3e-4},
    "vehicle.traction": {"max_effort_kn": 300.0, "max_power_kw": 4000.0, "max_speed_kmh": 100.0},
    "vehicle.braking": {"max_effort_kn": 100.0, "friction_effort_kn": 400.0},
    "timetable.travel_time_s": 5000.0,
}
WHOLE = {"line.limits_hold_for": "whole_train"}
FRONT, MIDDLE = {"vehicle.gradient_at": "front"}, {"vehicle.gradient_at": "middle"}


def sections(*rows: tuple[float, ...]) -> dict[str, Any]:
    """Sections of length [m], gradient [per mille] and limit [km/h]."""
    names = ("length_m", "gradient_permille", "speed_limit_kmh")
    return {"line.sections": [dict(zip(names, row, strict=False)) for row in rows]}


def limits(*rows: tuple[float, float, float]) -> dict[str, Any]:
    return {"line.speed_limits": [dict(zip(("from_m", "to_m", "limit_kmh"), row, strict=True)) for row in rows]}


def stop(position_m: float, dwell_s: float = 0.0) -> dict[str, Any]:
    return {"line.stations": [{"position_m": position_m, "dwell_s": dwell_s}]}


def document(*changes: dict[str, Any]) -> dict[str, Any]:
    return change_document(PLAIN, {key: value for change in (FREIGHT, *changes) for key, value in change.items()})


class OwnRun:
    """The fastest run by passes forward and backward in v squared, midpoint rule, at 1 m."""

    def __init__(self, doc: dict[str, Any]) -> None:
        self.vehicle, line = doc["vehicle"], doc["line"]
        self.mass_kg = self.vehicle["tare_kg"]
        self.inertia_kg = self.mass_kg * (1 + self.vehicle["rotating_mass_factor"])
        limit_ms, self.grade = self._profile(line)
        speed2 = np.minimum(np.append(limit_ms, limit_ms[-1]), np.append(limit_ms[0], limit_ms)) ** 2
        stations = line.get("stations", ())
        speed2[[0, -1, *(int(one["position_m"]) for one in stations)]] = 0.0
        self.speed2 = self._passes(speed2)
        speed = np.sqrt(self.speed2)
        self.time_s = float(np.sum(2 / (speed[1:] + speed[:-1]))) + sum(one.get("dwell_s", 0) for one in stations)

    def _profile(self, line: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
        train = int(self.vehicle.get("length_m", 0))
        rows = [(int(one["length_m"]), one) for one in line["sections"]]
        top = self.vehicle["traction"]["max_speed_kmh"]
        limit = np.concatenate([np.full(n, min(one.get("speed_limit_kmh", top), top)) for n, one in rows]) / KMH
        grade = np.concatenate([np.full(n, one.get("gradient_permille", 0) / 1000) for n, one in rows])
        for one in line.get("speed_limits", ()):
            part = slice(int(one["from_m"]), int(one["to_m"]))
            limit[part] = np.minimum(limit[part], one["limit_kmh"] / KMH)
        count, before = len(limit), np.append(np.full(train, grade[0]), grade)
        if "limits_hold_for" in line:
            limit = np.array([limit[max(k - train, 0) : k + 1].min() for k in range(count)])
        where = self.vehicle.get("gradient_at", "whole_train")
        if where == "middle":
            grade = before[train - train // 2 :][:count]
        elif where == "whole_train" and train:
            risen = np.append(0.0, np.cumsum(before))
            middle = 0.5 * (risen[1:] + risen[:-1])
            grade = (middle[train:] - middle[:count]) / train
        return limit, grade

    def resistance_n(self, speed2: float, k: int) -> float:
        terms, kmh2 = self.vehicle["resistance"].get, max(speed2, 0.0) * KMH**2
        specific = terms("constant_n_per_kn", 0) + terms("quadratic_n_per_kn_per_kmh2", 0) * kmh2
        absolute = terms("constant_n", 0) + terms("linear_n_per_kmh", 0) * math.sqrt(kmh2)
        absolute += terms("quadratic_n_per_kmh2", 0) * kmh2
        return self.mass_kg * G_MS2 * (specific / 1000 + self.grade[k]) + absolute

    def _passes(self, speed2: np.ndarray) -> np.ndarray:
        pull, brake = self.vehicle["traction"], self.vehicle["braking"]
        effort_n, power_w = pull["max_effort_kn"] * 1e3, pull["max_power_kw"] * 1e3
        curve = np.array(brake.get("curve", [[0, brake.get("max_effort_kn", 0)]]), dtype=float)
        most_ms2 = brake.get("max_deceleration_ms2", math.inf)

        def up(w: float, k: int) -> float:
            pulled = min(effort_n, power_w / math.sqrt(max(w, 1e-9)))
            return 2 * (pulled - self.resistance_n(w, k)) / self.inertia_kg

        def down(w: float, k: int) -> float:
            held = float(np.interp(math.sqrt(max(w, 0)) * KMH, *curve.T)) + brake.get("friction_effort_kn", 0)
            return 2 * min((held * 1e3 + self.resistance_n(w, k)) / self.inertia_kg, most_ms2)

        for _ in range(2):  # brakes that do not hold a speed are met by one that is lower before
            for rate, cells, step in ((up, range(len(speed2) - 1), 1), (down, range(len(speed2) - 1)[::-1], 0)):
                for k in cells:
                    here, there = (k, k + 1) if step else (k + 1, k)
                    half = speed2[here] + 0.5 * rate(speed2[here], k)
                    speed2[there] = min(speed2[there], max(speed2[here] + rate(half, k), 0.0))
        return speed2


SUMO = {
    **FRONT,
    "vehicle.tare_kg": 98e3,
    "vehicle.rotating_mass_factor": 0.07,
    "vehicle.resistance": {"constant_n": 1490.0, "linear_n_per_kmh": 4.0, "quadratic_n_per_kmh2": 0.31},
    "vehicle.traction": {"max_effort_kn": 125.0, "max_power_kw": 1900.0, "max_speed_kmh": 140.0},
    "vehicle.braking": {"max_effort_kn": 0.0, "friction_effort_kn": 95.0},
}
FADING = {"vehicle.braking": {"curve": [[0, 60], [40, 60], [100, 25]], "friction_effort_kn": 150.0}}
HUMP = sections((1500,), (300, 25), (300, -25), (3000,))
SHORTEST = {
    "limit until the rear has left (osrd #13641, sumo #3959)": (WHOLE, sections((9000,)), limits((4000, 4200, 50))),
    "two limits within the length of a train (osrd #9459)": (
        *(WHOLE, sections((9000,))),
        limits((4000, 4200, 50), (4500, 4800, 70)),
    ),
    "limit at the start": (WHOLE, sections((9000,)), limits((0, 200, 40))),
    "stop where a limit ends (osrd #7749)": (WHOLE, sections((5000, 0, 40), (5000, 0, 90)), stop(5000, 60)),
    "stop where a limit begins (osrd #7749)": (WHOLE, sections((5000, 0, 90), (5000, 0, 40)), stop(5000, 60)),
    "downhill that the brakes do not hold (osrd #13839)": (FRONT, sections((3000,), (800, -70), (3000, 4))),
    "hill climbed by run-up (osrd #6816)": (FRONT, sections((3000,), (700, 28), (3000,))),
    "20 km/h on a descent (maszyna #180)": (FRONT, sections((3000, -20), (1500, -20, 20), (2000,))),
    "gradient at the front (sumo #18111)": (FRONT, HUMP),
    "gradient at the middle (sumo #18111)": (MIDDLE, HUMP),
    "gradient under the train (sumo #18111)": (HUMP,),
    "train from its equation (sumo #14258)": (SUMO, sections((1500, 0, 80), (2000, 8), (2500, -5))),
    "brake that fades with speed (sumo #14748)": (FRONT, FADING, sections((4000,), (2500, 0, 30))),
}


@cache
def own_run(case: str) -> OwnRun:
    return OwnRun(document(*SHORTEST[case]))


@pytest.mark.parametrize("case", SHORTEST)
def test_the_fastest_run_is_that_of_two_passes(case: str) -> None:
    run, own = solve(scenario_from_document(document(*SHORTEST[case])), "fastest"), own_run(case)
    assert run.travel_time_s == pytest.approx(own.time_s, abs=0.03)
    found_ms = np.sqrt(np.interp(np.arange(len(own.speed2)), run.position_m, run.speed_ms**2))
    # cells of 10 m cut off the peak where braking begins
    assert np.abs(found_ms - np.sqrt(own.speed2)).max() * KMH < 0.25


def test_the_cases_distinguish_the_rules() -> None:
    """Seconds that the rear, the stop's side and the place of the gradient make: none of them is lost in 0.03 s."""
    front_s = OwnRun(document(sections((9000,)), limits((4000, 4200, 50)))).time_s
    rear, ends, begins, *hump = (
        own_run(case).time_s for word in ("until", "stop", "18111") for case in SHORTEST if word in case
    )
    assert rear > front_s + 5
    assert ends > begins + 5
    assert np.abs(np.diff(sorted(hump))).min() > 0.05


@pytest.mark.parametrize(("permille", "goes"), [(-0.1, True), (0.1, False)])
def test_a_start_uphill_is_decided_by_the_balance(permille: float, goes: bool) -> None:
    """osrd #3628: 300 kN carry 1200 t up 300 000 / (1200 x 9.81) - 1.5 = 23.984 per mille."""
    balance = 300e3 / (1200 * G_MS2) - 1.5
    scenario = scenario_from_document(document(FRONT, sections((800, balance + permille))))
    if goes:
        assert solve(scenario, "fastest").travel_time_s > 0
        return
    with pytest.raises(
        InfeasibleLineError,
        match=r"on a gradient of 24\.08 per mille, the train comes to a stand: its effort of at most 300 kN",
    ):
        solve(scenario, "fastest")


def test_a_train_of_10_000_t_and_2_km_is_proven() -> None:
    """NeTrainSim #27, ALTRIOS: the bound meets the energy."""
    heavy = {
        "vehicle.tare_kg": 1e7,
        "vehicle.length_m": 2000.0,
        "vehicle.resistance": {"constant_n_per_kn": 1.2, "quadratic_n_per_kn_per_kmh2": 1.5e-4},
        "vehicle.traction": {"max_effort_kn": 1200.0, "max_power_kw": 13e3, "max_speed_kmh": 80.0},
        "vehicle.braking": {"max_effort_kn": 400.0, "friction_effort_kn": 3000.0},
        "timetable.travel_time_s": 2600.0,
        "solver.mesh_m": 25.0,
    }
    line = sections((4000,), (6000, 5), (8000, -4), (6000, 0, 60), (6000, 3))
    run = solve(scenario_from_document(document(heavy, line)), "optimal", check=True)
    assert run.check.ok
    assert run.bound.energy_j <= run.energy.net_j <= run.bound.energy_j * (1 + 5e-4)


RAILTOOLKIT = (
    """
schema: https://railtoolkit.org/schema/rolling-stock.json
schema_version: "2022.05"
trains: [{id: ore, formation: [loco, wagon, wagon]}]
vehicles:
  - {id: loco, length: 16, mass: 84, mass_traction: 84, speed_limit: 90, rotation_mass: 1.1, base_resistance: 2.0,
     air_resistance: 9.0, tractive_effort: [[0, 160000], [90, 160000]]}
  - {id: wagon, vehicle_type: freight, length: 12, mass: 30, speed_limit: 80, base_resistance: 1.2,
     air_resistance: 4.0}
""",
    """
schema: https://railtoolkit.org/schema/running-path.json
schema_version: "2022.05"
paths: [{id: p, characteristic_sections: [[0, 60, 0], [2500, 80, 4.0], [5200, 70, -3.0], [8000, 70, 0]]}]
""",
)


def test_train_and_path_of_railtoolkit_have_the_running_time_of_two_passes() -> None:
    """TrainRuns.jl, test/data: means over the masses by hand, 8.4 t rotate, the brake is that of freight."""
    pytest.importorskip("yaml")
    train, path = (read_railtoolkit(SourceFile("r.yaml", text.encode())).document for text in RAILTOOLKIT)
    run = solve(scenario_from_document({**train, **path, "timetable": {"travel_time_s": 900.0}}), "fastest")
    mass_t, inertia_t = 84 + 2 * 30, 84 * 1.1 + 2 * 30
    by_hand = {
        "vehicle": {
            "tare_kg": mass_t * 1e3,
            "rotating_mass_factor": inertia_t / mass_t - 1,
            "length_m": 40,
            "resistance": {
                "constant_n_per_kn": (84 * 2.0 + 60 * 1.2) / mass_t,
                "quadratic_n_per_kn_per_kmh2": (84 * 9.0 + 60 * 4.0) / mass_t / 100**2,
            },
            "traction": {"max_effort_kn": 160.0, "max_power_kw": 1e6, "max_speed_kmh": 80.0},
            "braking": {"friction_effort_kn": 0.225 * inertia_t, "max_deceleration_ms2": 0.225},
        },
        "line": {
            "sections": [
                {"length_m": 2500, "speed_limit_kmh": 60},
                {"length_m": 2700, "speed_limit_kmh": 80, "gradient_permille": 4},
                {"length_m": 2800, "speed_limit_kmh": 70, "gradient_permille": -3},
            ]
        },
    }
    assert run.travel_time_s == pytest.approx(OwnRun(by_hand).time_s, abs=0.05)


# ---- reserves and energies


@pytest.mark.parametrize(
    ("changes", "percent"),
    [
        # osrd #7965: a stop must not cancel the margin behind it
        ((sections((4000,), (8000, 0, 80)), stop(4000, 30.0)), 20.0),
        # osrd #7426: imports failed where a linear margin meets a climb that is taken with full effort
        ((sections((4000,), (900, 28), (4000,)),), 20.0),
        ((sections((4000,), (900, 28), (4000,)),), 150.0),
    ],
    ids=["stop", "climb", "climb with much reserve"],
)
def test_a_linear_reserve_is_a_share_of_the_time_of_two_passes(changes: Any, percent: float) -> None:
    reserve = {"timetable": {"reserve_percent": percent}}
    run = solve(scenario_from_document(document(FRONT, *changes, reserve)), "linear_reserve", check=True)
    own = OwnRun(document(FRONT, *changes))
    dwell_s = sum(one["dwell_s"] for change in changes for one in change.get("line.stations", ()))
    assert run.check.ok
    assert run.travel_time_s == pytest.approx((1 + percent / 100) * (own.time_s - dwell_s) + dwell_s, abs=0.05)
    if dwell_s:
        before_s = OwnRun(document(FRONT, sections((4000,)))).time_s
        assert run.arrival_s(4000.0) == pytest.approx((1 + percent / 100) * before_s, abs=0.06)


@pytest.mark.parametrize("electric_kn", [100.0, 400.0])
def test_holding_a_speed_downhill_regenerates_what_gravity_leaves(electric_kn: float) -> None:
    """UBC-Solar/Simulation #151 (only decelerations counted), sumo #9576 (a limit of the electric brake), by hand.

    60 km/h over 5 km of -20 per mille: (20 - 1.5 - 3e-4 60^2) per mille of 11 772 kN is 205.07 kN of braking, of which
    the electric brake has what it can; 0.85 of it arrives at the supply side, and half of that is recuperated.
    """
    ends = {"travel_time_s": 310.0, "entry_speed_kmh": 60.0, "exit_speed_kmh": 60.0}
    brakes = {"vehicle.braking": {"max_effort_kn": electric_kn, "friction_effort_kn": 400.0}, "timetable": ends}
    run = solve(scenario_from_document(document(FRONT, sections((5000, -20, 60)), brakes)), "fastest")
    needed_kn = 1200 * G_MS2 / 1000 * (20 - 1.5 - 3e-4 * 60**2)
    assert run.travel_time_s == pytest.approx(300.0)
    assert run.energy_kwh == pytest.approx(-min(needed_kn, electric_kn) * 5 * 0.85 * 0.5 / 3.6, rel=1e-6)


# ---- files


def read_limits(text: str, **columns: Any) -> Any:
    return read_intervals(SourceFile("l.csv", text.encode()), "limits", ColumnMap(**columns))


@pytest.mark.parametrize(
    ("header", "rows", "words"),
    [
        ("maxspeed,maxspeed:forward,maxspeed:backward", ["90,,60", "90,70,"], "'maxspeed:forward' counts in one"),
        ("maxspeed:forward,maxspeed:backward", ["90,60", "70,"], "'maxspeed:forward' counts in one direction only"),
        (
            "maxspeed,direction",
            ["90,up", "60,down"],
            "several direction: down, up; choose one, as limits.direction=down",
        ),
    ],
)
def test_a_limit_of_one_direction_is_no_limit_of_both(header: str, rows: list[str], words: str) -> None:
    """hiddewie/OpenRailwayMap-vector PR 1018, sumo #6883: 90 km/h was taken where 70 hold in this direction."""
    text = f"from_m,to_m,{header}\n0,700,{rows[0]}\n700,1600,{rows[1]}\n"
    with pytest.raises(ScenarioError, match=words):
        read_limits(text)


def test_the_only_limit_of_one_direction_is_reported() -> None:
    (reading,) = (one.sentence for one in read_limits("from_m,to_m,maxspeed:backward [km/h]\n0,700,90\n").findings)
    assert reading == "l.csv: 'maxspeed:backward [km/h]' is taken as that of the run's direction."


def test_the_direction_that_the_user_names_is_read() -> None:
    text = "from_m,to_m,maxspeed,maxspeed:forward,direction\n0,700,90,80,up\n700,1600,90,70,up\n0,1600,60,50,down\n"
    table = read_limits(text, columns={"value": "maxspeed:forward"}, rows={"direction": "up"})
    assert [(one.from_m, one.value) for one in table.intervals] == [(0, 80), (700, 70)]


def test_a_gradient_table_that_ends_before_the_limits_is_reported() -> None:
    """openETCS/modeling #950."""
    gradients = read_intervals(
        SourceFile("g.csv", b"from_m,to_m,gradient_permille\n0,500,6\n500,900,-4\n"), "gradients"
    )
    line = build_line(gradients=gradients, limits=read_limits("from_m,to_m,limit_kmh\n0,800,80\n800,1700,60\n"))
    assert line.line.length_m == 1700
    assert any("nothing from 900 to 1,700 m, at the line's end: taken as level" in one for one in line.sentences)


def test_radii_of_left_curves_are_radii() -> None:
    """nuorail/ttobench PR 2 and osrd PR 550: left is negative."""
    text = b"from_m,to_m,radius_m\n0,300,-420\n300,900,infinity\n900,1500,680\n"
    curves = read_intervals(SourceFile("c.csv", text), "curves")
    assert [section.curve_radius_m for section in build_line(curves=curves).line.sections] == [420, 0, 680]


@pytest.mark.parametrize("after_midnight", [("24:00:10", "24:00:40", "24:02:45"), ("00:00:10", "00:00:40", "00:02:45")])
def test_hours_from_24_on_are_those_of_the_next_day(after_midnight: tuple[str, str, str]) -> None:
    """planarnetwork/transxchange2gtfs #15 and google/transitfeed #474: from 23:58:30 it is 100, 130 and 255 s."""
    arrival, departure, end = after_midnight
    text = f"stop,km,arrival_time,departure_time\nA,0,,23:58:30\nB,1.2,{arrival},{departure}\nC,2.5,{end},\n"
    stations = read_stations(SourceFile("t.csv", text.encode()))
    level = read_intervals(SourceFile("g.csv", b"from_km,to_km,gradient_permille\n0,2.5,0\n"), "gradients")
    line = build_line(gradients=level, stations=stations)
    assert line.travel_time_s == 255
    assert line.document["line"]["stations"][1] == {"name": "B", "position_m": 1200, "arrival_s": 100, "dwell_s": 30}


def test_efforts_in_another_unit_are_asked_about() -> None:
    """osrd #2825: daN taken for N, 30 kN for 1600 t, which no train starts with."""
    stock = """{"railjson_version": "3.2", "name": "f", "length": 450, "mass": 1600000, "max_speed": 27.8,
        "inertia_coefficient": 1.05, "const_gamma": 0.4, "rolling_resistance": {"A": 21000, "B": 300, "C": 12},
        "effort_curves": {"default_mode": "x", "modes": {"x": {"is_electric": true, "curves": [],
            "default_curve": {"speeds": [0, 27.8], "max_efforts": [30000, 7000]}}}}}"""
    asked = [one.sentence for one in read_osrd_stock(SourceFile("f.json", stock.encode())).findings]
    assert "f.json: vehicle.traction.curve, greatest effort = 30 kN for a train of 1600 t: is this right?" in asked


NORTH_M = 111_132.954 - 559.822 * math.cos(math.radians(100)) + 1.175 * math.cos(math.radians(200))
"""A degree of the meridian at 50 degrees, by the series of WGS 84."""


def track(rows: list[tuple[int, float, str]], breaks: tuple[int, ...] = ()) -> SourceFile:
    """Points on a meridian: clock [s], distance [m] and more XML; a new segment before some of them."""
    points = [
        ("</trkseg><trkseg>" if k in breaks else "")
        + f'<trkpt lat="{50 + s / NORTH_M:.9f}" lon="8"><time>2026-03-28T23:{50 + t // 60}:{t % 60:02}Z</time>'
        f"{more}</trkpt>"
        for k, (t, s, more) in enumerate(rows)
    ]
    return SourceFile("t.gpx", f"<gpx><trk><trkseg>{''.join(points)}</trkseg></trk></gpx>".encode())


def test_two_points_at_one_time_are_no_leap_of_the_speed() -> None:
    """bentasker/PHP-GPX-Ingest #6, martin-ueding/geo-activity-playground #328: 16 m/s, one point stamped as before."""
    run = run_table(recorder_cells(track([(t if t != 77 else 76, 16.0 * t, "") for t in range(148)])))
    assert np.asarray(run.columns["speed_kmh"]) == pytest.approx(16 * 3.6, abs=0.01)
    assert len(run.columns["time_s"]) == 147


def test_a_gap_between_segments_is_reported_with_its_length() -> None:
    """kirienko/gpx-player #30, tumic0/GPXSee #304: 30 s without signal at 16 m/s are 480 m."""
    seconds = [*range(61), *range(90, 140)]
    run = run_table(recorder_cells(track([(t, 16.0 * t, "") for t in seconds], breaks=(61,))))
    assert any("Its 2 segments are joined by straight lines, 480 m in all." in note for note in run.notes)
    assert run.columns["position_m"][-1] == pytest.approx(16.0 * 139, abs=0.02)


def test_the_speed_in_the_extension_of_a_point_is_read() -> None:
    """timschneeb/KomootGPX #17: GPX 1.1 has it as gpxtpx:speed, in m/s, beside other values."""
    values = "<x:TrackPointExtension><x:hr>88</x:hr><x:speed>15.25</x:speed></x:TrackPointExtension>"
    more = f"<extensions>{values}</extensions>"
    run = run_table(recorder_cells(track([(t, 16.0 * t, more) for t in range(60)])))
    assert np.asarray(run.columns["speed_kmh"]) == pytest.approx(15.25 * 3.6)


@pytest.mark.parametrize(
    ("stamps", "words"),
    [
        # PowerwallCompanion #17 and wcbonner/GoveeBTTempLogger #14: the clock set back, and set forward
        (
            ("2026-10-25T02:59:{}", "2026-10-25T02:00:{}"),
            "1792893600 s in row 62 must be at least that of the row before",
        ),
        (
            ("2026-03-29T01:59:{}", "2026-03-29T03:00:{}"),
            "Samples are missing: 3601 s after row 61; the distance there",
        ),
        (("2026-10-25T02:59:{}+02:00", "2026-10-25T02:00:{}+01:00"), ""),
    ],
    ids=["back", "forward", "with its offset"],
)
def test_a_clock_that_is_set_is_no_hour_of_driving(stamps: tuple[str, str], words: str) -> None:
    """60 s at 16 m/s before and after it are 1904 m, not 59 km."""
    rows = "".join(f"{stamp.format(f'{t:02}')},57.6\n" for stamp in stamps for t in range(60))
    cells = recorder_cells(SourceFile("d.csv", f"time,speed_kmh\n{rows}".encode()))
    if "must be" in words:
        with pytest.raises(RecordingError, match=words):
            run_table(cells)
        return
    run = run_table(cells)
    assert any(words in note for note in run.notes)
    if not words:
        assert run.columns["position_m"][-1] == pytest.approx(16.0 * 119)


def recorded(head: str, rows: list[str]) -> Any:
    return run_table(recorder_cells(SourceFile("r.csv", "\n".join([head, *rows]).encode())))


@pytest.mark.parametrize("head", ["time_seconds,speed_meters_per_second", "t (in s),v (in m/s)"])
def test_a_unit_in_words_is_a_unit(head: str) -> None:
    """Headings of NREL/altrios, speed_trace.csv, and railtoolkit/TrainRuns.jl, export.jl: 60 s at 16 m/s are 960 m."""
    run = recorded(head, [f"{t},16" for t in range(61)])
    assert run.columns["position_m"][-1] == pytest.approx(960)
    assert not any("No unit" in note for note in run.notes)


def test_speeds_that_cover_another_distance_are_reported() -> None:
    """Columns of a program that counts in SI, without units: 16 km/h over 60 s are 266.67 m of 960 m."""
    run = recorded("s,v,t", [f"{16 * t},16,{t}" for t in range(61)])
    assert any("v in km/h covers 266.67 m, but s rises by 960 m" in note for note in run.notes)


def test_several_trains_of_a_simulation_are_refused() -> None:
    """Output of eclipse-sumo (fcd) has all vehicles at each step; the second was left out as a repetition."""
    rows = [f"{t},{name},{k * 36},{k * 10 * t}" for t in range(61) for k, name in enumerate("AB", 1)]
    with pytest.raises(RecordingError, match="rows are of several trains, vehicle_id = A, B; keep the rows of one"):
        recorded("time,vehicle_id,speed_kmh,position_m", rows)
