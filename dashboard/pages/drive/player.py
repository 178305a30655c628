"""The bar that plays the run: a train runs along the track in the browser, and numbers and advice follow."""

from typing import Any

import numpy as np
import param
from panel.custom import JSComponent

from railjoule.core import Trajectory
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.dashboard.charts.quantities import ENERGY, POSITION, POWER, SPEED, SUPPLY_CURRENT, TIME
from railjoule.dashboard.look import words
from railjoule.dashboard.look.scripts import module

DIGITS = 4
"""Decimals of the numbers that are sent: of a MW they are 100 W."""
STYLE = """
:host { padding: 6px 14px 0 20px; box-sizing: border-box; }
.player { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 12px; font: 13px/1.4 var(--rj-font);
  color: var(--rj-ink2); font-feature-settings: "tnum" 1; }
button, select { min-height: 28px; border: 1px solid var(--rj-line2); border-radius: 6px; background: var(--rj-surface);
  color: var(--rj-ink); font: inherit; cursor: pointer; }
button { min-width: 68px; border-color: var(--rj-accent); background: var(--rj-accent); color: var(--rj-surface);
  font-weight: 600; }
:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
input { flex: 1 1 140px; min-width: 100px; height: 24px; margin: 0; accent-color: var(--rj-accent); cursor: pointer; }
.readouts { display: flex; flex-wrap: wrap; gap: 0 14px; }
.readouts span { min-width: 62px; white-space: nowrap; text-align: right; }
.readouts span[hidden] { display: none; }
.idle { visibility: hidden; }
.readouts b { color: var(--rj-ink); font-weight: 600; }
@media (max-width: 899px) { :host { padding: 6px 14px 0; } .idle { display: none; } }
"""

READOUTS = (
    ("time", "s", 1, ""),
    ("position", "m", 0, ""),
    ("speed", "km/h", 1, ""),
    ("power", "MW", 2, "stepped"),
    ("current", "A", 0, "stepped"),
    ("energy", "kWh", 2, ""),
)
"""Column, unit and digits of each number, and whether it is constant in each cell."""
NUMBER = '<span><b data-quantity="{0}" data-digits="{2}" data-stepped="{3}">\u2013</b> {1}</span>'
BAR = """
<button type="button">Play</button>
<select aria-label="Pace"><option value="1">1\u00d7</option><option value="4">4\u00d7</option>
<option value="10">10\u00d7</option></select>
<input type="range" min="0" max="1" step="1" value="0" aria-label="Time of the run, s">
<span class="readouts idle">{}</span>
"""
"""The numbers have their place before there is a run to play."""


class Player(JSComponent):
    """The bar; the browser requests the run before it is played."""

    html = param.String(default=BAR.format("".join(NUMBER.format(*one) for one in READOUTS)), doc="The bar.")
    wanted = param.Boolean(default=False, doc="Whether the browser needs the columns of the run.")
    run = param.Dict(default={}, doc="The quantities over time, and when each instruction begins.")
    train = param.List(default=[], doc="The sources of the train in the figures of speed and track, by id.")
    over_time = param.Boolean(default=False, doc="Whether the figures are over time.")

    _esm = module("player")
    _stylesheets = [STYLE]  # noqa: RUF012


def played_columns(run: Trajectory) -> dict[str, Any]:
    """Return the quantities of a run over time for the browser, and the times when its instructions begin [s]."""
    line = run.scenario.line.in_running_order()
    quantities = [TIME, POSITION, SPEED, ENERGY, POWER, *([] if run.supply_current_a is None else [SUPPLY_CURRENT])]
    columns = {quantity.name: np.round(quantity.values(run), DIGITS).tolist() for quantity in quantities}
    height = np.interp(run.position_m, section_borders(line), height_profile(line))
    starts = [run.phases[group[0]].start_s for group in words.instruction_groups(run.advice)]
    return {**columns, "height": np.round(height, DIGITS).tolist(), "starts": starts}
