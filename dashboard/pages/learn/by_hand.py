"""The lesson that is driven: its component, the line for the browser, and the comparison of a try with the optimum."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import param

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.arrays import IntArray
from railjoule.core.drive.geared import BRAKING_EFFICIENCY, TRACTION_EFFICIENCY
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import braking_envelope
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.simulation.manual import (
    WALKING_PACE_MS,
    drive_manually,
    parting_node,
    read_commands,
    require_drivable,
)
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn.verdict import (
    FASTER,
    MORE,
    PLAYED_TEXTS,
    Verdict,
    best_try,
    compare,
    details,
    outcome,
)

PRESET = "metro-with-limit"
"""A metro train with a constant efficiency; "Open on Drive" opens it."""
LESSON_CHANGES = {"solver.mesh_m": 2.0}
"""A command holds for whole cells: of two metres, a tenth of a second at 72 km/h."""
TRIES = 3
DID = ("kept power", "coasted", "braked")
"""Words for the action of a driver, by the number of the command."""
DOES = {
    "full_power": "it uses full power",
    "part_power": "it uses part power",
    "hold": "it holds its speed",
    "coast": "it coasts",
    "brake": "it brakes",
    "stand": "it stands",
}
"""Words for the action of the best run, by the name of the phase."""
HERE = "From {place} m on you differ from the best run: {does}."
THERE = "You {did} to {place} m: there you are {speed} km/h {faster} and have used {energy} kWh {more}."


@cache
def lesson() -> tuple[Scenario, MeshedLine]:
    """Return the scenario of the lesson over its mesh, and its meshed line."""
    scenario = load_scenario(PRESET).replace(**LESSON_CHANGES)
    return scenario, build_meshed_line(scenario)


@cache
def best_run() -> Trajectory:
    """Return the optimum of the lesson, with its proven bound."""
    return solve(lesson()[0])


def driven_run(text: str) -> Trajectory:
    """Return the run of a try; errors as `read_commands`."""
    scenario, mesh = lesson()
    return drive_manually(scenario, mesh, read_commands(text, mesh.cell_count))


def begin(text: str) -> dict[str, Any]:
    """Return the initial data of the browser: the line, and the run of a link to race; errors as `read_commands`."""
    scenario, mesh = lesson()
    run = driven_run(text) if text else None
    ghost = run and {"times": run.time_s.tolist(), "speeds": run.speed_ms.tolist()}
    return {"mesh": mesh_arrays(mesh), "timetable_s": scenario.travel_time_s, "tries": TRIES, "ghost": ghost}


def judge(text: str) -> Verdict:
    """Return the comparison of a try with the optimum; errors as `read_commands`."""
    scenario, mesh = lesson()
    commands, run, best = read_commands(text, mesh.cell_count), driven_run(text), best_run()
    node = parting_node(run, best)
    parting = None if node is None else {"position": float(run.nodes_m[node]), "node": node}
    sentences = () if node is None else _parting_words(run, best, commands, node)
    return compare(("driven", text), run, best, scenario.travel_time_s, sentences, parting=parting)


def _parting_words(run: Trajectory, best: Trajectory, commands: IntArray, node: int) -> tuple[str, str]:
    """Return sentences on the first difference of two runs: its position, and the action of each run there."""
    # at the end of the cell, as a border between phases may lie within it
    phase = next(phase for phase in best.phases if phase.end_m >= run.nodes_m[node + 1])
    others = np.flatnonzero(commands[node:] != commands[node])
    end = node + int(others[0]) if len(others) else len(commands)
    faster = float(run.node_speed_ms[end] - best.node_speed_ms[end])
    cost = float(run.supply_energy_j[end] - best.supply_energy_j[end]) / J_PER_KWH
    there = THERE.format(
        did=DID[commands[node]],
        place=words.number(run.nodes_m[end], 0),
        speed=words.speed(abs(faster), 0),
        faster=FASTER[faster < 0],
        energy=words.energy(abs(cost)),
        more=MORE[cost < 0],
    )
    return HERE.format(place=words.number(run.nodes_m[node], 0), does=DOES[phase.phase]), there


def mesh_arrays(mesh: MeshedLine) -> dict[str, Any]:
    """Return a meshed line as `driving.js` takes it, in SI units.

    Raises
    ------
    ScenarioError
        If its drive has no constant efficiency, or `railjoule.core.simulation.manual` does not take the meshed line.
    """
    data = mesh.data
    require_drivable(mesh)
    if data.drive_kind != CONSTANT_EFFICIENCY:
        raise ScenarioError("The lesson needs a drive with a constant efficiency.")
    if data.starting_n > 0:
        raise ScenarioError("The lesson needs a train without starting resistance.")
    return {
        "position": mesh.position_m.tolist(),
        "length": data.cell_length_m.tolist(),
        "constant": (data.resistance_constant_n + data.line_force_n).tolist(),
        "running_constant": data.resistance_constant_n,
        "linear": data.resistance_linear,
        "quadratic": np.asarray(data.resistance_quadratic).tolist(),
        "gradient": mesh.gradient_force_n.tolist(),
        "limit": mesh.cell_limit_ms.tolist(),
        "highest2": braking_envelope(mesh).tolist(),
        "entering2": max(float(data.fixed_speed2[0]), 0.0),
        "pace2": WALKING_PACE_MS**2,
        "half_inertia": data.half_inertia_kg,
        "traction": _limit(data.traction),
        "braking": _limit(data.braking),
        "friction": data.friction_effort_n,
        "most_acceleration": _finite(data.max_acceleration_ms2),
        "most_deceleration": _finite(data.max_deceleration_ms2),
        "auxiliary": data.auxiliary_power_w,
        "driving_efficiency": float(data.drive_parameters[TRACTION_EFFICIENCY]),
        "braking_efficiency": float(data.drive_parameters[BRAKING_EFFICIENCY]),
        "recuperated": data.recuperation_factor,
    }


def _limit(limit: EffortLimit) -> dict[str, Any]:
    return {"constant": limit.constant_n, "power": _finite(limit.power_w), "table": limit.table.tolist()}


def _finite(value: float) -> float | None:
    """Return a number that JSON can hold: None for one that is infinite."""
    return float(value) if np.isfinite(value) else None


# ---- on the page


class DriveIt(Form):
    """The lesson, driven in the browser and judged by the server.

    Parameters
    ----------
    field : str
        The field of the page that holds what was driven last.
    hear : callable
        Called with the field, what the browser reports, and the text of what was driven.
    """

    _esm = module("drive_it")

    title = param.String(default="", doc="Its heading.")
    text = param.String(default="", doc="The task of the lesson.")
    given = param.Dict(default={}, doc="Initial data of the lesson.")
    verdict = param.Dict(default={}, doc="How what was played compares with the best; empty before the first time.")
    refusals = param.Integer(default=0, doc="Counts what could not be judged.")
    lead = param.String(default="", doc="The lesson that a link leads to.")

    def __init__(self, field: str, hear: Callable[[str, str, str], None]) -> None:
        texts = PLAYED_TEXTS[field]
        super().__init__(
            lambda message: hear(field, str(message.get("what", "")), str(message.get("text", ""))),
            title=texts["title"],
            text=texts["text"],
            css_classes=[f"rj-lesson-{field}"],
            stylesheets=[played_css()],
        )

    @property
    def view(self) -> "DriveIt":
        """The part of the page."""
        return self

    def begin(self, given: dict[str, Any]) -> None:
        """Begin with what the module of the lesson returns."""
        self.given = given

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self.refusals += 1

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, beside the tries so far where they are counted."""
        best = best_try(tries)
        self.verdict = {
            **verdict.curves,
            "head": str(outcome(verdict) + buttons(verdict, tries)),
            "details": str(details(verdict, tries)),
            "tried": len(tries),
            "note": f"best of your tries {words.energy(best.kwh)}" if best else "",
            # the same may be judged twice, and only a difference is sent to the browser
            "count": self.verdict.get("count", 0) + 1,
        }


def buttons(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
    """Return the buttons that lead on from a verdict."""
    plain, left = Markup(""), TRIES - len(tries)
    again = f"Drive again ({left} left)" if left else "Begin again with three tries"
    open_it = PLAYED_TEXTS[verdict.field]["open"]
    made = (("again", again, plain), ("watch", "Watch your run", plain), ("open", open_it, Markup(" class=main")))
    pieces = (markup("<button type=button data-what={}{}>{}</button>", what, kind, label) for what, label, kind in made)
    return markup("<div class=row>{}</div>", joined(pieces))
