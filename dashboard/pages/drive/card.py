"""The driver's card: the advice with its times on one page to print, which needs no network."""

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.track import as_steps, limits_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.parts.html import stop_times

WIDTH, HEIGHT = 1000.0, 219.0
"""Of the figure of speed, in the units of assets/templates/driver_card.html."""
LARGEST_PX, SMALLEST_PX, PAGE_PX = 30.0, 8.0, 660.0
"""Sizes of the type; height that rows, heading and foot share."""
COLUMN_LINES = 9
"""Up to so many instructions stand in one column."""


def driver_card(run: Trajectory, note: str = "") -> str:
    """Return the card of a run as an HTML file; `note` is a sentence at its foot."""
    scenario, groups = run.scenario, words.instruction_groups(run.advice)
    starts = [clock(run.phases[group[0]].start_s) for group in groups]
    texts = [text[0].upper() + text[1:] for text in words.advice_in_words(run.advice)]
    stops = stop_times(run)
    borders, limits = limits_of(scenario)
    top = max(float(np.max(limits)), run.max_speed_kmh)

    def points(places: FloatArray, speeds: FloatArray) -> str:
        x, y = WIDTH * places / run.distance_m, HEIGHT * (1 - speeds / top)
        return " ".join(f"{one:.1f},{other:.1f}" for one, other in zip(x, y, strict=True))

    rows = max(len(texts) if len(texts) <= COLUMN_LINES else (len(texts) + 1) // 2, len(stops))
    return template("driver_card").render(
        title=words.title(scenario.title),
        train=words.subtitle(run.distance_m, scenario.vehicle),
        departure=clock(0.0),
        arrival=clock(run.travel_time_s),
        instructions=list(zip(starts, texts, strict=True)),
        stops=stops,
        speed=points(run.position_m, run.speed_ms / MS_PER_KMH),
        limit=points(*as_steps(borders, limits)),
        distance=words.distance(run.distance_m),
        top=words.number(top, 0),
        note=note,
        size=f"{min(LARGEST_PX, max(SMALLEST_PX, PAGE_PX / (1.85 * rows + 11))):.1f}",
    )
