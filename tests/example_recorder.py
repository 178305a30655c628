"""Make `assets/imports/example-recorder.csv`: what a recorder would write of a run over the example line of Files.

`python -m tests.example_recorder`, from the top folder. The run is simulated: its driver keeps to 35 km/h in the middle
of the line, and drives as well as that allows. The columns are those of a French recorder, with current and voltage,
but neither power nor energy.
"""

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from railjoule.core import load_scenario, solve
from railjoule.core.scenario import parse_scenario
from railjoule.dashboard.pages.files.brought import Brought
from railjoule.dashboard.pages.files.compute import Request, Stretch, read_files, taken
from railjoule.dashboard.pages.files.page import EXAMPLE_LINE, sources
from tests.recordings import samples

TARGET = Path(__file__).parents[1] / "assets" / "imports" / "example-recorder.csv"
CATENARY_V = 750.0
SLOW = {"from_m": 5000.0, "to_m": 6500.0, "limit_kmh": 35.0}
HEADINGS = (
    "Horodatage",
    "Distance parcourue (m)",
    "Vitesse (km/h)",
    "Effort (kN)",
    "Courant ligne (A)",
    "Tension cat\u00e9naire (V)",
)


def table() -> str:
    """Return the rows of the recorder."""
    brought = tuple(Brought(number, one.name, one.content) for number, one in enumerate(sources(EXAMPLE_LINE), 1))
    chosen = tuple(file.with_choice("rows NOM_VOIE", "V1") if file.kind == "gradients" else file for file in brought)
    *_, reading = read_files(Request(chosen, Stretch(), load_scenario("metro-with-limit")))
    scenario = parse_scenario(taken(reading.offers[0], reading.offers[0].time_s))
    limits = [limit.model_dump() for limit in scenario.line.speed_limits]
    columns = samples(solve(scenario.replace(**{"line.speed_limits": [*limits, SLOW]})), seed=9)
    distance = np.append(0.0, np.cumsum(0.5 * (columns["speed_ms"][1:] + columns["speed_ms"][:-1])))
    start, rows = datetime(2026, 1, 31, 7, 14), [";".join(HEADINGS)]
    for k, place in enumerate(distance):
        numbers = (
            f"{place:.0f}",
            f"{3.6 * columns['speed_ms'][k]:.2f}",
            f"{columns['effort_kn'][k]:.1f}",
            f"{1e3 * columns['power_kw'][k] / CATENARY_V:.1f}",
            f"{CATENARY_V:.0f}",
        )
        moment = (start + timedelta(seconds=float(columns["time_s"][k]))).strftime("%d/%m/%Y %H:%M:%S")
        rows.append(";".join([moment, *numbers]).replace(".", ","))
    return "\r\n".join(rows)


if __name__ == "__main__":
    # as programs of Western Europe write it
    TARGET.write_bytes(table().encode("cp1252"))
