"""What each page computes, in one table: what it lays over the scenario, and the program that gives its number.

Share, the report and the copied command line read it here, so that none of them tells another run than the page shows.
"""

from collections.abc import Callable, Mapping
from typing import Any

from railjoule.core.scenario.disturbance import Disturbance
from railjoule.dashboard.pages.learn.model import LESSONS
from railjoule.dashboard.state.program import SOLVE, PageRun, Program, simulation
from railjoule.dashboard.state.workbench import Workbench

ACTUAL_RUN = simulation("actual_run", "actual_run")
FOLLOWING = simulation("simulate_following", "following")


def page_run(state: Workbench) -> PageRun:
    """Return what the page in sight computes."""
    page = state.pages.get(state.page)
    return PAGE_RUNS.get(state.page, _plan)(state) if page is None else page.page_run()


def _plan(state: Workbench) -> PageRun:
    return PageRun(SOLVE, {"strategy": state.chosen_now})


def actual_run(state: Workbench, changes: Mapping[str, Any]) -> PageRun:
    """Return the run of a day; where nothing is otherwise than planned, that is the plan.

    The commands would follow that plan all the same, and under target braking curves if the scenario has them.
    """
    if not _is_as_planned(state, changes):
        return PageRun(ACTUAL_RUN, {**followed(state), **changes})
    nothing_else: Mapping[str, Any] = {"disturbance": {}} if state.scenario.edited.disturbance != Disturbance() else {}
    return PageRun(SOLVE, {"strategy": changes["strategy"], **followed(state), **nothing_else})


def _is_as_planned(state: Workbench, changes: Mapping[str, Any]) -> bool:
    """Return whether nothing of a day differs from the plan: a later departure shifts the run and nothing else."""
    day, measured = state.scenario.edited.disturbance, state.scenario.edited.simulation
    load = changes.get("disturbance.actual_load_factor", day.actual_load_factor)
    return (
        not state.day.events
        and load in {None, state.scenario.load_percent / 100}
        and changes.get("disturbance.coordinate_error_m", day.coordinate_error_m) == 0
        and changes.get("simulation.speed_error", measured.speed_error) == 0
        and not any(changes.get("simulation.sensor_errors_m", measured.sensor_errors_m) or ())
        and day.resistance_factor == day.line_voltage_factor == 1
        and day.rail_condition in {None, state.scenario.edited.line.rail_condition}
    )


def followed(state: Workbench) -> Mapping[str, Any]:
    """Return what keeps a command from simulating the control loop that a file may ask for."""
    in_loop = state.scenario.edited.simulation.kind == "field_oriented"
    return {"simulation.kind": "following"} if in_loop else {}


def _study(state: Workbench) -> PageRun:
    """Return the study that is shown; before there is one, the plan."""
    study = state.study.study
    if study is None:
        return PageRun(SOLVE, {"strategy": state.chosen_now})
    over = {field.name: (field.low, field.high) for field in study.fields}
    body = (
        f"table = sweep(scenario, {over!r}, {study.sample}, {study.method!r}, seed={study.seed}, "
        f"columns={study.columns!r})\nprint(table.to_dataframe())\n"
    )
    untold = "The page shows a study of many runs, whose ranges no scenario file has; study sweep takes them."
    return PageRun(Program({"sweep": "railjoule.core.studies.sweep"}, body, ""), {"strategy": study.strategy}, untold)


def _learn(state: Workbench) -> PageRun:
    values = {lesson.name: float(getattr(state.learn, lesson.name)) for lesson in LESSONS}
    body = (
        f"for lesson, value in {values!r}.items():\n"
        "    for name, run in compute_lesson(LessonRequest(lesson, value)).runs.items():\n"
        '        print(f"{lesson}, {name}: {run.energy_kwh} kWh")\n'
    )
    module = "railjoule.dashboard.pages.learn.compute"
    program = Program({"LessonRequest": module, "compute_lesson": module}, body, "", of_scenario=False)
    untold = "The lessons have scenarios of their own, which no command runs."
    return PageRun(program, {"strategy": state.chosen_now}, untold)


def _measured_runs(state: Workbench) -> PageRun:
    """Return the plan: a measured run stands beside it, and its file in no scenario."""
    shown = state.measured_runs.measured is not None
    untold = "The page shows measured runs, whose files no scenario file has; this is the plan." if shown else ""
    return PageRun(SOLVE, {"strategy": state.chosen_now}, untold)


PAGE_RUNS: Mapping[str, Callable[[Workbench], PageRun]] = {
    "Start": _plan,
    "Study": _study,
    "Learn": _learn,
    "Measured runs": _measured_runs,
    "Import": _plan,
    "Help": _plan,
}
"""By the name of the page; one without an entry shows the plan."""
